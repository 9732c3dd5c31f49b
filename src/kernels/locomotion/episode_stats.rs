//! Sums up the episodes that ended. Shader: `shaders/locomotion/episode_stats.wgsl`.

use super::locomotion_layout::{state_f32, state_u32};
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for episode_stats {
        /// Environments of the batch.
        pub envs: u32,
    }
}

/// Numbers of a tally: episodes, successes, collisions, truncations, steps, summed return.
pub const SUMS: usize = 6;

/// Queues the shader on `gpu`.
///
/// `state_f32` is `[state_f32::FIELDS][envs]`, `state_u32` `[state_u32::FIELDS][envs]`; what is
/// summed up there becomes zero. `sums` is `[SUMS]`.
pub fn launch(
    gpu: &Gpu,
    state_f32: &Buffer<f32>,
    state_u32: &Buffer<u32>,
    sums: &Buffer<f32>,
    params: &Params,
) {
    gpu.launch(
        &shader::EPISODE_STATS,
        [1, 1, 1],
        &[state_f32, state_u32, sums],
        params,
    );
}

/// The counts among the sums, in their order: fields of `state_u32`. The returns follow.
const COUNTS: [usize; SUMS - 1] = [
    state_u32::EPISODES,
    state_u32::SUCCESSES,
    state_u32::COLLISIONS,
    state_u32::TRUNCATIONS,
    state_u32::LENGTHS,
];

/// The shader's computation on the host.
pub fn twin(state_f32: &mut [f32], state_u32: &mut [u32], sums: &mut [f32], params: &Params) {
    let envs = params.envs as usize;
    for (sum, field) in sums.iter_mut().zip(COUNTS) {
        let part = &mut state_u32[field * envs..][..envs];
        *sum = part.iter().sum::<u32>() as f32;
        part.fill(0);
    }
    let returns = &mut state_f32[state_f32::RETURNS * envs..][..envs];
    sums[COUNTS.len()] = returns.iter().sum();
    returns.fill(0.0);
}

/// What each of `envs` environments adds to the sums, `[SUMS][envs]`.
pub fn rows(state_f32: &[f32], state_u32: &[u32], envs: usize) -> Vec<f32> {
    let counts = COUNTS
        .iter()
        .flat_map(|field| &state_u32[field * envs..][..envs]);
    let counts = counts.map(|&count| count as f32);
    let returns = &state_f32[state_f32::RETURNS * envs..][..envs];
    counts.chain(returns.iter().copied()).collect()
}
