//! The diversity loss of every row and its gradient (Peng et al. 2022, equation 15): two latents are to lead to
//! actions as far apart as they are. Shader: `shaders/learn/diversity_loss.wgsl`.
//!
//! The loss is (1 - d / (.5 - .5 cos))^2, d the mean squared difference of the mean actions under both latents,
//! cos the cosine between these. The other action is that of the policy before the update, and the gradient, which
//! goes through the agent's own alone, counts twice in place of going through both.

use crate::gpu::{Buffer, Gpu, groups, shader};

crate::shader_params! {
    pub struct Params for diversity_loss {
        /// Rows of the minibatch.
        pub rows: u32,
        /// The first sample.
        pub start: u32,
        /// Numbers of a sample.
        pub width: u32,
        /// Numbers of a latent.
        pub latent: u32,
        /// Weight of a row.
        pub weight: f32,
    }
}

/// Keeps latents that are the same from asking for nothing over nothing.
const LEAST: f32 = 1e-5;

/// Queues the shader on `gpu`, behind [`ppo_loss`](super::ppo_loss) and with the same arrays. `samples` are
/// `[..][width]`: what PPO's loss reads, then the mean action under another latent, the agent's own latent, and
/// that other one.
pub fn launch(
    gpu: &Gpu,
    dims: &Buffer<u32>,
    samples: &Buffer<f32>,
    outputs: &Buffer<f32>,
    output_grads: &Buffer<f32>,
    params: &Params,
) {
    gpu.launch(
        &shader::DIVERSITY_LOSS,
        groups(&shader::DIVERSITY_LOSS, params.rows as usize),
        &[dims, samples, outputs, output_grads],
        params,
    );
}

/// The gradient for `rows` with respect to the `means`, `[rows][action]`.
pub fn gradients(rows: &[&[f32]], means: &[f32], params: &Params) -> Vec<f32> {
    let actions = means.len() / rows.len().max(1);
    let latent = params.latent as usize;
    let pairs = rows.iter().zip(means.chunks_exact(actions));
    let gradient = |(row, mean): (&&[f32], &[f32])| {
        let (rest, latents) = row.split_at(row.len() - 2 * latent);
        let (own, other) = latents.split_at(latent);
        let other_mean = &rest[rest.len() - actions..];
        let apart = 0.5 - 0.5 * cosine(own, other) + LEAST;
        let changes = mean.iter().zip(other_mean).map(|(a, b)| a - b);
        let changes: Vec<f32> = changes.collect();
        let square: f32 = changes.iter().map(|change| change * change).sum();
        let missing = 1.0 - square / actions as f32 / apart;
        let slope = -8.0 * params.weight * missing / (apart * actions as f32);
        changes.into_iter().map(move |change| slope * change)
    };
    pairs.flat_map(gradient).collect()
}

fn cosine(a: &[f32], b: &[f32]) -> f32 {
    let product = |a: &[f32], b: &[f32]| -> f32 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    product(a, b) / (product(a, a) * product(b, b)).sqrt().max(1e-6)
}
