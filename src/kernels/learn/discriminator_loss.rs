//! The discriminator's loss of every row and its gradient. Shader:
//! `shaders/learn/discriminator_loss.wgsl`.

use crate::gpu::{Buffer, Gpu, groups, shader};

crate::shader_params! {
    pub struct Params for discriminator_loss {
        /// Rows of the minibatch.
        pub rows: u32,
        /// The first sample.
        pub start: u32,
        /// Numbers of a sample.
        pub width: u32,
        /// 1 for the hinge loss, 0 for binary cross-entropy.
        pub hinge: u32,
        /// Outputs of the network that are the discriminator's.
        pub heads: u32,
        /// 1 / rows of the mean.
        pub inv_count: f32,
    }
}

/// What is added up: loss; rows that were recorded, and those of them taken for it; rows of agents, and
/// those of them taken for it; cosines of an encoder.
pub const SUMS: usize = shader::discriminator_loss::constants::SUMS as usize;
/// Index of the cosines, which [`encoder_loss`](super::encoder_loss) adds up.
pub const COSINE: usize = SUMS - 1;

/// Queues the shader on `gpu`.
///
/// `dims`: numbers of a window, parameters, outputs. `samples` are `[..][width]`, a window and then 1 if it
/// was recorded, else 0; `outputs` and `output_grads` `[rows][outputs]`, whose heads come first, `extras`
/// `[rows][SUMS]`.
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
        &shader::DISCRIMINATOR_LOSS,
        groups(&shader::DISCRIMINATOR_LOSS, params.rows as usize),
        &[dims, samples, outputs, output_grads, extras],
        params,
    );
}

/// The shader's computation on the host, of `rows` that hold 1 behind their `window` numbers if they were
/// recorded: writes the gradients over the heads of the `outputs`, `[rows][outputs]`, and adds to `extras`,
/// `[SUMS]`.
pub fn rows(
    rows: &[&[f32]],
    window: usize,
    outputs: &mut [f32],
    extras: &mut [f32],
    params: &Params,
) {
    let (width, heads) = (outputs.len() / rows.len().max(1), params.heads as usize);
    let weight = params.inv_count / heads as f32;
    for (row, outputs) in rows.iter().zip(outputs.chunks_exact_mut(width)) {
        let outputs = &mut outputs[..heads];
        let recorded = row[window] > 0.5;
        let sign = if recorded { -1.0 } else { 1.0 };
        let sum: f32 = outputs.iter().sum();
        for out in outputs {
            let (loss, slope) = loss(sign * *out, params);
            extras[0] += loss / heads as f32;
            *out = sign * slope * weight;
        }
        let right = f32::from(u8::from(sign * sum < 0.0));
        let counts = &mut extras[if recorded { 1 } else { 3 }..][..2];
        counts[0] += 1.0;
        counts[1] += right;
    }
}

/// The loss and its slope of an output that is `wrong` by so much: binary cross-entropy (Peng et al. 2021,
/// with cross-entropy for least squares), or the hinge (Xu and Karamouzas 2021, equation 6).
fn loss(wrong: f32, params: &Params) -> (f32, f32) {
    if params.hinge == 1 {
        let hinge = (1.0 + wrong).max(0.0);
        return (hinge, f32::from(u8::from(hinge > 0.0)));
    }
    let softplus = wrong.max(0.0) + (1.0 + (-wrong.abs()).exp()).ln();
    (softplus, 1.0 / (1.0 + (-wrong).exp()))
}
