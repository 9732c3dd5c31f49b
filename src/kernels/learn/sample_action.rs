//! Draws actions from the policy's Gaussian. Shader: `shaders/learn/act.wgsl`.

use crate::kernels::rng::{gaussian, random4};
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::features::TRAJECTORY_DIM;

crate::shader_params! {
    pub struct Params for sample_action {
        pub envs: u32,
        /// The first one's number in its batch: random numbers are drawn by it.
        pub first: u32,
        pub seed: u32,
        /// Steps of the run so far: the random numbers' counter.
        pub step_counter: u32,
    }
}

const NOISE: u32 = 0x4e4f_4953;
const HALF_LOG_TAU: f32 = 0.918_938_5;

pub fn launch(
    gpu: &Gpu,
    mean: &Buffer<f32>,
    log_std: &Buffer<f32>,
    action: &Buffer<f32>,
    log_prob: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::SAMPLE_ACTION, params.envs as usize);
    gpu.launch(
        &shader::SAMPLE_ACTION,
        groups,
        &[mean, log_std, action, log_prob],
        params,
    );
}

pub fn twin(
    mean: &[f32],
    log_std: &[f32],
    action: &mut [f32],
    log_prob: &mut [f32],
    params: &Params,
) {
    let std: Vec<f32> = log_std.iter().map(|log| log.exp()).collect();
    for (env, log_prob) in log_prob.iter_mut().enumerate().take(params.envs as usize) {
        let mut sum = 0.0;
        for i in 0..TRAJECTORY_DIM {
            let bits = random4(
                params.seed,
                params.first + env as u32,
                params.step_counter,
                NOISE + i as u32,
            );
            let noise = gaussian(bits);
            let at = env * TRAJECTORY_DIM + i;
            action[at] = mean[at] + std[i] * noise;
            sum -= 0.5 * noise * noise + log_std[i] + HALF_LOG_TAU;
        }
        *log_prob = sum;
    }
}
