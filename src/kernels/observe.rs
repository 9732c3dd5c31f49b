//! What the policy sees. Shader: `shaders/world/observe.wgsl`.

use super::layout::{CELLS, GOAL, GOAL_SCALE, MAPS, real, whole};
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::database::PADDED;
use crate::motion::features::POSE;
use crate::motion::frame::to_local;

crate::shader_params! {
    pub struct Params for observe {
        pub envs: u32,
        /// Rows of an environment's maps; 1 without maps.
        pub rows: u32,
        /// Numbers of an observation.
        pub width: u32,
        /// Where this step's ends begin in `ended`.
        pub offset: u32,
        /// Write only the observations of environments that ended in one of these ways, `1 << end`.
        pub only: u32,
        /// The first observation to write.
        pub to: u32,
    }
}

pub fn launch(
    gpu: &Gpu,
    features: &Buffer<f32>,
    real: &Buffer<f32>,
    whole: &Buffer<u32>,
    ended: &Buffer<u32>,
    maps: &Buffer<u32>,
    observation: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::OBSERVE, (params.envs * params.rows) as usize);
    gpu.launch(
        &shader::OBSERVE,
        groups,
        &[features, real, whole, ended, maps, observation],
        params,
    );
}

pub fn twin(
    features: &[[f32; PADDED]],
    real: &[f32],
    whole: &[u32],
    ended: &[u32],
    maps: &[u32],
    observation: &mut [f32],
    params: &Params,
) {
    let envs = params.envs as usize;
    for (env, row) in observation
        .chunks_exact_mut(params.width as usize)
        .skip(params.to as usize)
        .take(envs)
        .enumerate()
    {
        if params.only >> ended[params.offset as usize + env] & 1 == 0 {
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
        if row.len() > GOAL {
            let (now, previous) = maps[env * MAPS * CELLS..][..MAPS * CELLS].split_at(CELLS);
            for (cell, seen) in row[GOAL..].chunks_exact_mut(MAPS).enumerate() {
                let bit = |map: &[u32]| (map[cell / CELLS] >> (cell % CELLS) & 1) as f32;
                (seen[0], seen[1]) = (bit(now), bit(previous));
            }
        }
    }
}
