//! Motion-matching queries: pose of the frame now shown, trajectory from the action.
//! Shader: `shaders/locomotion/build_query.wgsl`.

use super::locomotion_layout::state_u32;
use crate::gpu::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE, TRAJECTORY_DIM};

crate::shader_params! {
    pub struct Params for build_query {
        /// Environments of the batch.
        pub envs: u32,
        /// Where the first number of the actions is.
        pub action_at: u32,
    }
}

/// Queues the shader on `gpu`.
///
/// `features` is `[frames][ROW_STRIDE]`, `queries` `[envs][ROW_STRIDE]`, `action`
/// `[envs][TRAJECTORY_DIM]` from `params.action_at` on, all normalised; `state_u32` is
/// `[state_u32::FIELDS][envs]`.
pub fn launch(
    gpu: &Gpu,
    features: &Buffer<f32>,
    state_u32: &Buffer<u32>,
    action: &Buffer<f32>,
    queries: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::BUILD_QUERY, params.envs as usize);
    gpu.launch(
        &shader::BUILD_QUERY,
        groups,
        &[features, state_u32, action, queries],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    features: &[[f32; ROW_STRIDE]],
    state_u32: &[u32],
    action: &[f32],
    queries: &mut [[f32; ROW_STRIDE]],
    params: &Params,
) {
    let envs = params.envs as usize;
    for (env, row) in queries.iter_mut().enumerate().take(envs) {
        let frame = state_u32[state_u32::FRAME * envs + env] as usize;
        row[..POSE_DIM].copy_from_slice(&features[frame][..POSE_DIM]);
        let action = &action[params.action_at as usize + env * TRAJECTORY_DIM..][..TRAJECTORY_DIM];
        row[POSE_DIM..FEATURE_DIM].copy_from_slice(action);
        row[FEATURE_DIM..].fill(1.0);
    }
}
