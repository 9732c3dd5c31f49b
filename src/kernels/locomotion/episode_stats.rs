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

/// The shader's computation on the host.
pub fn twin(state_f32: &mut [f32], state_u32: &mut [u32], sums: &mut [f32], params: &Params) {
    let envs = params.envs as usize;
    let mut count = |field: usize| {
        let part = &mut state_u32[field * envs..(field + 1) * envs];
        let sum: u32 = part.iter().sum();
        part.fill(0);
        sum as f32
    };
    let returns = &mut state_f32[state_f32::RETURNS * envs..(state_f32::RETURNS + 1) * envs];
    sums[..SUMS].copy_from_slice(&[
        count(state_u32::EPISODES),
        count(state_u32::SUCCESSES),
        count(state_u32::COLLISIONS),
        count(state_u32::TRUNCATIONS),
        count(state_u32::LENGTHS),
        returns.iter().sum(),
    ]);
    returns.fill(0.0);
}
