//! Generalised advantage estimation. Shader: `shaders/learn/gae.wgsl`.

use crate::kernels::termination;
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for gae {
        pub envs: u32,
        /// Length of the rollout.
        pub steps: u32,
        pub gamma: f32,
        pub lambda: f32,
        /// Ends after which the value of the last real state goes on, `1 << end`.
        pub bootstrap: u32,
        /// Steps of `final_value`: 1 if no environment has two bootstrapped ends in the rollout.
        pub final_steps: u32,
    }
}

pub fn launch(
    gpu: &Gpu,
    reward: &Buffer<f32>,
    termination: &Buffer<u32>,
    value: &Buffer<f32>,
    next_value: &Buffer<f32>,
    final_value: &Buffer<f32>,
    scale: &Buffer<f32>,
    advantage: &Buffer<f32>,
    target_value: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::GAE, params.envs as usize);
    let buffers: [&dyn crate::gpu::buffer::Argument; 8] = [
        reward,
        termination,
        value,
        next_value,
        final_value,
        scale,
        advantage,
        target_value,
    ];
    gpu.launch(&shader::GAE, groups, &buffers, params);
}

pub fn twin(
    reward: &[f32],
    termination: &[u32],
    value: &[f32],
    next_value: &[f32],
    final_value: &[f32],
    scale: &[f32],
    advantage: &mut [f32],
    target_value: &mut [f32],
    params: &Params,
) {
    let envs = params.envs as usize;
    let state_f32 = |value: f32| value * scale[1] + scale[0];
    for env in 0..envs {
        let (mut after, mut sum) = (real(next_value[env]), 0.0);
        for step in (0..params.steps as usize).rev() {
            let at = step * envs + env;
            if termination[at] != termination::RUNNING {
                let last = final_value[if params.final_steps == 1 { env } else { at }];
                let goes_on = params.bootstrap >> termination[at] & 1 == 1;
                (after, sum) = (if goes_on { real(last) } else { 0.0 }, 0.0);
            }
            let now = real(value[at]);
            sum = reward[at] + params.gamma * after - now + params.gamma * params.lambda * sum;
            advantage[at] = sum;
            target_value[at] = sum + now;
            after = now;
        }
    }
}
