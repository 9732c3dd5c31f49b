//! Reward for moving so that the encoder finds the latent again (Peng et al. 2022, equation 12, brought from
//! -1 to 1 to 0 to 1). Shader: `shaders/learn/skill_reward.wgsl`.

use super::encoder_loss::cosine;
use crate::gpu::{Buffer, Gpu, groups, shader};

crate::shader_params! {
    pub struct Params for skill_reward {
        /// Samples of the rollout.
        pub samples: u32,
        /// Outputs of the network.
        pub outputs: u32,
        /// Those of them that are the discriminator's; the others are the encoder's.
        pub heads: u32,
    }
}

/// Queues the shader on `gpu`.
///
/// `output` is `[samples][outputs]`, `latents` are `[samples][outputs - heads]`, `reward` takes `[samples]`.
pub fn launch(
    gpu: &Gpu,
    output: &Buffer<f32>,
    latents: &Buffer<f32>,
    reward: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::SKILL_REWARD, params.samples as usize);
    gpu.launch(
        &shader::SKILL_REWARD,
        groups,
        &[output, latents, reward],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(output: &[f32], latents: &[f32], reward: &mut [f32], params: &Params) {
    let (outputs, heads) = (params.outputs as usize, params.heads as usize);
    let rows = output.chunks_exact(outputs);
    let rows = rows.zip(latents.chunks_exact(outputs - heads));
    for (reward, (row, latent)) in reward.iter_mut().zip(rows) {
        *reward = 0.5 + 0.5 * cosine(&row[heads..], latent).0;
    }
}
