//! Keeps the latents of agents and draws new ones when their time is over. Shader:
//! `shaders/learn/advance_latents.wgsl`.

use crate::gpu::shader::advance_latents::constants::STREAM;
use crate::gpu::{Argument, Buffer, Gpu, groups, shader};
use crate::kernels::rng::{gaussian, index_below, random4, uniform01};
use crate::kernels::termination::RUNNING;

crate::shader_params! {
    pub struct Params for advance_latents {
        /// Rows of the batch.
        pub rows: u32,
        /// Number of the first row in the whole batch.
        pub first: u32,
        /// Seed of the random numbers.
        pub seed: u32,
        /// Their counter, another for every step.
        pub step_counter: u32,
        /// Index of the step's first termination.
        pub at: u32,
        /// Rows of the final observations before this step's.
        pub final_row: u32,
        /// Least steps for which a latent is kept.
        pub least: u32,
        /// Most steps for which a latent is kept, each number from `least` on as likely.
        pub most: u32,
        /// 1 to draw all latents, whatever has ended.
        pub opening: u32,
        /// Standard deviation of latents about their centres, before they are brought to the sphere.
        pub spread: f32,
    }
}

/// Queues the shader on `gpu`.
///
/// `dims` are the numbers of a latent and of the inner observation, and how many centres there are; with 0 centres a
/// latent has any direction. `termination` is `[steps][rows]`, `centres` `[centres][1 + latent]`: the share of a centre
/// and all before it, then the centre. Where an episode has ended, `final_observation`
/// `[final_steps][rows][inner + latent]` gets `inner_final` `[final_steps][rows][inner]` and the latent. `latents` are
/// `[rows][latent]`, `steps_left` `[rows]`: steps for which a latent is still kept.
pub fn launch(
    gpu: &Gpu,
    dims: &Buffer<u32>,
    termination: &Buffer<u32>,
    centres: &Buffer<f32>,
    inner_final: &Buffer<f32>,
    final_observation: &Buffer<f32>,
    latents: &Buffer<f32>,
    steps_left: &Buffer<u32>,
    params: &Params,
) {
    let buffers: [&dyn Argument; 7] = [
        dims,
        termination,
        centres,
        inner_final,
        final_observation,
        latents,
        steps_left,
    ];
    let groups = groups(&shader::ADVANCE_LATENTS, params.rows as usize);
    gpu.launch(&shader::ADVANCE_LATENTS, groups, &buffers, params);
}

/// The shader's computation on the host.
pub fn twin(
    dims: &[u32],
    termination: &[u32],
    centres: &[f32],
    inner_final: &[f32],
    final_observation: &mut [f32],
    latents: &mut [f32],
    steps_left: &mut [u32],
    params: &Params,
) {
    let [dim, inner, centre_count] = [0, 1, 2].map(|at| dims[at] as usize);
    let centres = &centres[..centre_count * (1 + dim)];
    let rows = latents.chunks_exact_mut(dim).zip(steps_left);
    for (row, (latent, age)) in rows.enumerate().take(params.rows as usize) {
        let opening = params.opening == 1;
        let ended = !opening && termination[params.at as usize + row] != RUNNING;
        if ended {
            let last = params.final_row as usize + row;
            let out = &mut final_observation[last * (inner + dim)..][..inner + dim];
            out[..inner].copy_from_slice(&inner_final[last * inner..][..inner]);
            out[inner..].copy_from_slice(latent);
        }
        if !opening && !ended && *age > 1 {
            *age -= 1;
        } else {
            *age = draw(params.first + row as u32, centres, latent, params);
        }
    }
}

/// Draws a latent for the row with this number in the whole batch. Returns how long it is kept, steps.
pub fn draw(key: u32, centres: &[f32], latent: &mut [f32], params: &Params) -> u32 {
    let random = |stream: u32| random4(params.seed, key, params.step_counter, STREAM + stream);
    let [age, lot, ..] = random(0);
    for (i, value) in latent.iter_mut().enumerate() {
        *value = gaussian(random(1 + i as u32));
    }
    if let Some(centre) = drawn_centre(centres, latent.len(), uniform01(lot)) {
        for (value, centre) in latent.iter_mut().zip(centre) {
            *value = centre + params.spread * *value;
        }
    }
    to_sphere(latent);
    params.least + index_below(age, params.most - params.least + 1)
}

/// The centre whose share a lot falls into, if there are any.
fn drawn_centre(centres: &[f32], dim: usize, lot: f32) -> Option<&[f32]> {
    let mut rows = centres.chunks_exact(1 + dim);
    let last = rows.len().checked_sub(1)?;
    let passed = rows.clone().take(last).filter(|row| row[0] <= lot).count();
    rows.nth(passed).map(|row| &row[1..])
}

/// Brings a latent to length 1; one without a direction stays as it is.
pub fn to_sphere(latent: &mut [f32]) {
    let square: f32 = latent.iter().map(|value| value * value).sum();
    let scale = 1.0 / square.sqrt().max(1e-6);
    latent.iter_mut().for_each(|value| *value *= scale);
}
