//! Actions drawn from the policy's Gaussian. Shader: `shaders/learn/sample_action.wgsl`.

use crate::gpu::shader::sample_action::constants::NOISE;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::rng::{gaussian, random4};

crate::shader_params! {
    pub struct Params for sample_action {
        /// Rows that act.
        pub rows: u32,
        /// Numbers of an action.
        pub action: u32,
        /// Their first row in the arrays.
        pub row: u32,
        /// Their first row's number in its batch: random numbers are drawn by it.
        pub first: u32,
        /// Seed of the random numbers.
        pub seed: u32,
        /// Steps of the run so far: the random numbers' counter.
        pub step_counter: u32,
    }
}

const HALF_LOG_TAU: f32 = 0.918_938_5;

/// Queues the shader on `gpu`.
///
/// `mean` and `action` are `[..][action]` and `log_prob` is `[..]`, read and written from
/// `params.row` on; `log_std` is `[action]`. `log_prob` is the natural logarithm of the density at
/// the action.
pub fn launch(
    gpu: &Gpu,
    mean: &Buffer<f32>,
    log_std: &Buffer<f32>,
    action: &Buffer<f32>,
    log_prob: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::SAMPLE_ACTION, params.rows as usize);
    gpu.launch(
        &shader::SAMPLE_ACTION,
        groups,
        &[mean, log_std, action, log_prob],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    mean: &[f32],
    log_std: &[f32],
    action: &mut [f32],
    log_prob: &mut [f32],
    params: &Params,
) {
    let std: Vec<f32> = log_std.iter().map(|log| log.exp()).collect();
    let (width, first) = (params.action as usize, params.row as usize);
    for row in 0..params.rows {
        let mut sum = 0.0;
        let at = (first + row as usize) * width;
        for i in 0..width {
            let noise = noise(params.seed, params.first + row, params.step_counter, i);
            action[at + i] = mean[at + i] + std[i] * noise;
            sum -= 0.5 * noise * noise + log_std[i] + HALF_LOG_TAU;
        }
        log_prob[first + row as usize] = sum;
    }
}

/// The noise of a number of an action, of the row that has the number `row` in its batch.
pub fn noise(seed: u32, row: u32, step_counter: u32, number: usize) -> f32 {
    gaussian(random4(seed, row, step_counter, NOISE + number as u32))
}
