//! What a low-level policy observes under a high level. Shader: `shaders/learn/low_level_input.wgsl`.

use super::advance_latents::to_sphere;
use crate::gpu::{Buffer, Gpu, groups, shader};

crate::shader_params! {
    pub struct Params for low_level_input {
        /// Rows of the batch.
        pub rows: u32,
        /// Numbers of an observation.
        pub observation: u32,
        /// Index of the first action.
        pub at: u32,
    }
}

/// A shorter vector has no direction.
const LEAST: f32 = 1e-6;

/// Queues the shader on `gpu`.
///
/// `observation` is `[rows][observation]`, `action` holds `[rows][latent]` from `params.at` on, `widths` are
/// the numbers that a body observes of itself, which come first in its observation, and those of a latent;
/// `input` takes `[rows][style + latent]`: the body's numbers, then the latent, a unit vector.
pub fn launch(
    gpu: &Gpu,
    observation: &Buffer<f32>,
    action: &Buffer<f32>,
    widths: &Buffer<u32>,
    input: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::LOW_LEVEL_INPUT, params.rows as usize);
    let buffers: [&dyn crate::gpu::Argument; 4] = [observation, action, widths, input];
    gpu.launch(&shader::LOW_LEVEL_INPUT, groups, &buffers, params);
}

/// The shader's computation on the host.
pub fn twin(
    observation: &[f32],
    action: &[f32],
    widths: &[u32],
    input: &mut [f32],
    params: &Params,
) {
    let [style, latent] = [0, 1].map(|width| widths[width] as usize);
    let observations = observation.chunks_exact(params.observation as usize);
    let actions = action[params.at as usize..].chunks_exact(latent);
    let inputs = input.chunks_exact_mut(style + latent);
    let rows = inputs.zip(observations.zip(actions));
    for (input, (observation, action)) in rows.take(params.rows as usize) {
        input[..style].copy_from_slice(&observation[..style]);
        input[style..].copy_from_slice(action);
        to_latent(&mut input[style..]);
    }
}

/// Turns an action into the latent that it means: its numbers count within one, its length not at all. One without
/// a direction is the first axis.
pub fn to_latent(action: &mut [f32]) {
    action.iter_mut().for_each(|x| *x = x.clamp(-1.0, 1.0));
    if action.iter().map(|x| x * x).sum::<f32>().sqrt() < LEAST {
        action.fill(0.0);
        action[0] = 1.0;
    }
    to_sphere(action);
}
