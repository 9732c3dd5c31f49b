//! The encoder's loss of every row and its gradient (Peng et al. 2022, equation 13, with a von Mises-Fisher
//! distribution: minus the cosine between the latent and the direction found). Shader:
//! `shaders/learn/encoder_loss.wgsl`.

use super::discriminator_loss::COSINE;
use crate::gpu::{Buffer, Gpu, groups, shader};

crate::shader_params! {
    pub struct Params for encoder_loss {
        /// Rows of the minibatch.
        pub rows: u32,
        /// The first sample.
        pub start: u32,
        /// Numbers of a sample.
        pub width: u32,
        /// Outputs of the network that are the discriminator's.
        pub heads: u32,
        /// Weight of a row.
        pub weight: f32,
    }
}

/// Least length of an output that has a direction.
const LEAST: f32 = 1e-6;

/// Queues the shader on `gpu`, behind [`discriminator_loss`](super::discriminator_loss) and with the same
/// arrays: `samples` are `[..][width]`, a window, its label, then the latent, zero where there is none.
pub fn launch(
    gpu: &Gpu,
    dims: &Buffer<u32>,
    samples: &Buffer<f32>,
    outputs: &Buffer<f32>,
    output_grads: &Buffer<f32>,
    extras: &Buffer<f32>,
    params: &Params,
) {
    gpu.launch(
        &shader::ENCODER_LOSS,
        groups(&shader::ENCODER_LOSS, params.rows as usize),
        &[dims, samples, outputs, output_grads, extras],
        params,
    );
}

/// The shader's computation on the host: writes the gradients over the `outputs` behind the heads, and adds
/// to `extras`.
pub fn rows(rows: &[&[f32]], outputs: &mut [f32], extras: &mut [f32], params: &Params) {
    let width = outputs.len() / rows.len().max(1);
    for (row, outputs) in rows.iter().zip(outputs.chunks_exact_mut(width)) {
        let found = &mut outputs[params.heads as usize..];
        let latent = &row[row.len() - found.len()..];
        let (cosine, inv_length) = cosine(found, latent);
        for (found, latent) in found.iter_mut().zip(latent) {
            let away = latent - cosine * *found * inv_length;
            *found = -params.weight * away * inv_length;
        }
        extras[COSINE] += cosine;
    }
}

/// The cosine between an output and a latent of length 1, and 1 / the output's length.
pub fn cosine(found: &[f32], latent: &[f32]) -> (f32, f32) {
    let product = |other: &[f32]| -> f32 { found.iter().zip(other).map(|(a, b)| a * b).sum() };
    let inv_length = 1.0 / product(found).sqrt().max(LEAST);
    (product(latent) * inv_length, inv_length)
}
