//! Motion-matching queries: pose of the frame now shown, trajectory from the action.
//! Shader: `shaders/world/query.wgsl`.

use super::layout::whole;
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::database::PADDED;
use crate::motion::features::{FEATURE, POSE, TRAJECTORY};

crate::shader_params! {
    pub struct Params for query {
        pub envs: u32,
    }
}

pub fn launch(
    gpu: &Gpu,
    features: &Buffer<f32>,
    whole: &Buffer<u32>,
    action: &Buffer<f32>,
    queries: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::QUERY, params.envs as usize);
    gpu.launch(
        &shader::QUERY,
        groups,
        &[features, whole, action, queries],
        params,
    );
}

pub fn twin(
    features: &[[f32; PADDED]],
    whole: &[u32],
    action: &[f32],
    queries: &mut [[f32; PADDED]],
    params: &Params,
) {
    let envs = params.envs as usize;
    for (env, row) in queries.iter_mut().enumerate().take(envs) {
        let frame = whole[whole::FRAME * envs + env] as usize;
        row[..POSE].copy_from_slice(&features[frame][..POSE]);
        row[POSE..FEATURE].copy_from_slice(&action[env * TRAJECTORY..(env + 1) * TRAJECTORY]);
        row[FEATURE..].fill(1.0);
    }
}
