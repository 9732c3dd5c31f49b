//! Adapts the actor's learning rate between the steps of an update. Shader: `shaders/learn/adapt_lr.wgsl`.

use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for adapt_lr {
        /// Index of the KL divergence in the objective's sums.
        pub kl_at: u32,
        /// 1 / samples of the minibatch.
        pub inv_count: f32,
        /// 1 in the first minibatch of an epoch.
        pub first: u32,
        /// KL divergence, in nats, that is aimed at.
        pub desired_kl: f32,
        /// Least factor of the learning rate.
        pub least: f32,
        /// Largest factor of the learning rate.
        pub most: f32,
    }
}

/// Numbers of `rates`: factors of the learning rate, of the actor and of the critic; the sum of the KL
/// divergence before this minibatch.
pub const RATES: usize = 3;
/// By how much the rate changes at once.
const FACTOR: f32 = 1.5;

/// Queues the shader on `gpu`. `sums` are what the objective has added up in this epoch; `rates` is
/// `[RATES]`.
pub fn launch(gpu: &Gpu, sums: &Buffer<f32>, rates: &Buffer<f32>, params: &Params) {
    gpu.launch(&shader::ADAPT_LR, [1, 1, 1], &[sums, rates], params);
}

/// The shader's computation on the host.
pub fn twin(sums: &mut [f32], rates: &mut [f32], params: &Params) {
    let sum = sums[params.kl_at as usize];
    let before = if params.first == 1 { 0.0 } else { rates[2] };
    let kl = (sum - before) * params.inv_count;
    rates[2] = sum;
    if kl > 2.0 * params.desired_kl {
        rates[0] = (rates[0] / FACTOR).max(params.least);
    } else if kl < 0.5 * params.desired_kl {
        rates[0] = (rates[0] * FACTOR).min(params.most);
    }
}
