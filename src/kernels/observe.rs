//! What the policy sees. Shader: `shaders/world/observe.wgsl`.

use super::layout::{GOAL_SCALE, OBSERVATION, end, real, whole};
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::database::PADDED;
use crate::motion::features::POSE;
use crate::motion::frame::to_local;

crate::shader_params! {
    pub struct Params for observe {
        pub envs: u32,
        /// Where this step's ends begin in `ended`.
        pub offset: u32,
        /// Write only the rows that ended like this; all of them for `RUNNING`.
        pub only: u32,
    }
}

pub fn launch(
    gpu: &Gpu,
    features: &Buffer<f32>,
    real: &Buffer<f32>,
    whole: &Buffer<u32>,
    ended: &Buffer<u32>,
    observation: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::OBSERVE, params.envs as usize);
    gpu.launch(
        &shader::OBSERVE,
        groups,
        &[features, real, whole, ended, observation],
        params,
    );
}

pub fn twin(
    features: &[[f32; PADDED]],
    real: &[f32],
    whole: &[u32],
    ended: &[u32],
    observation: &mut [f32],
    params: &Params,
) {
    let envs = params.envs as usize;
    for (env, row) in observation
        .chunks_exact_mut(OBSERVATION)
        .enumerate()
        .take(envs)
    {
        if params.only != end::RUNNING && ended[params.offset as usize + env] != params.only {
            continue;
        }
        let at = |field: usize| real[field * envs + env];
        let frame = whole[whole::FRAME * envs + env] as usize;
        row[..POSE].copy_from_slice(&features[frame][..POSE]);
        let offset = [
            at(real::TARGET_X) - at(real::X),
            at(real::TARGET_Z) - at(real::Z),
        ];
        let goal = to_local(offset, [at(real::HEADING_X), at(real::HEADING_Z)]);
        row[POSE] = goal[0] * GOAL_SCALE;
        row[POSE + 1] = goal[1] * GOAL_SCALE;
    }
}
