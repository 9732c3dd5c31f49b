//! Which moment of the references an episode of the task `track` begins in. Shader:
//! `shaders/humanoid/begin_track.wgsl`.

use super::draw_starts::start_of;
use super::track_state::{LAST, ROW, TRACK_STATE};
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::strided::scatter;

crate::shader_params! {
    pub struct Params for begin_track {
        /// Environments of the batch.
        pub envs: u32,
        /// Number of the first environment in the whole batch.
        pub first: u32,
        /// Seed of the random numbers.
        pub seed: u32,
        /// Their counter, that with which the start state is drawn.
        pub reset_counter: u32,
        /// Start states to draw from.
        pub count: u32,
    }
}

/// Queues the shader on `gpu`.
///
/// `mask` is `[envs]`, not 0 where an episode begins; `start_rows` `[count][2]`: of each start state its row of
/// the references, and the last row of its motion; `task_state` `[TRACK_STATE][envs]`.
pub fn launch(
    gpu: &Gpu,
    mask: &Buffer<u32>,
    start_rows: &Buffer<u32>,
    task_state: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::BEGIN_TRACK, params.envs as usize);
    let buffers: [&dyn crate::gpu::Argument; 3] = [mask, start_rows, task_state];
    gpu.launch(&shader::BEGIN_TRACK, groups, &buffers, params);
}

/// The shader's computation on the host.
pub fn twin(mask: &[u32], start_rows: &[u32], task_state: &mut [f32], params: &Params) {
    let envs = params.envs as usize;
    let mut state = [0.0; TRACK_STATE];
    for env in (0..envs).filter(|&env| mask[env] != 0) {
        begin(start_rows, env, &mut state, params);
        scatter(task_state, envs, env, 0, &state);
    }
}

/// Sets the state of an environment whose episode begins.
pub fn begin(start_rows: &[u32], env: usize, state: &mut [f32], params: &Params) {
    let key = params.first + env as u32;
    let start = start_of(params.seed, key, params.reset_counter, params.count) as usize;
    state[ROW] = start_rows[2 * start] as f32;
    state[LAST] = start_rows[2 * start + 1] as f32;
}
