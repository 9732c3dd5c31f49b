//! Reward for moving in the style of recordings. Shader: `shaders/learn/style_reward.wgsl`.

use crate::gpu::{Buffer, Gpu, groups, shader};

crate::shader_params! {
    pub struct Params for style_reward {
        /// Samples of the rollout.
        pub samples: u32,
        /// Outputs of the network.
        pub outputs: u32,
        /// Those of them that are the discriminator's, which come first.
        pub heads: u32,
        /// 1 for the hinge loss, 0 for binary cross-entropy.
        pub hinge: u32,
    }
}

/// Least probability of having been taken for an agent that the reward tells apart.
const LEAST: f32 = 1e-4;

/// Queues the shader on `gpu`.
///
/// `output` is `[samples][outputs]`, `reward` takes `[samples]`.
pub fn launch(gpu: &Gpu, output: &Buffer<f32>, reward: &Buffer<f32>, params: &Params) {
    let groups = groups(&shader::STYLE_REWARD, params.samples as usize);
    gpu.launch(&shader::STYLE_REWARD, groups, &[output, reward], params);
}

/// The shader's computation on the host.
pub fn twin(output: &[f32], reward: &mut [f32], params: &Params) {
    let rows = output.chunks_exact(params.outputs as usize);
    for (reward, row) in reward.iter_mut().zip(rows).take(params.samples as usize) {
        let heads = &row[..params.heads as usize];
        let sum: f32 = heads.iter().map(|&out| reward_of(out, params)).sum();
        *reward = sum / params.heads as f32;
    }
}

/// Reward for an output of the discriminator: -log(1 - sigmoid(out)) (the paper's equation 2; AMP's
/// implementation), or the output within 1 of zero (Xu and Karamouzas 2021, equation 7).
fn reward_of(out: f32, params: &Params) -> f32 {
    if params.hinge == 1 {
        return out.clamp(-1.0, 1.0);
    }
    let taken = 1.0 - 1.0 / (1.0 + (-out).exp());
    -taken.max(LEAST).ln()
}
