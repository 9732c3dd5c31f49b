//! What the policy sees. Shader: `shaders/world/observe.wgsl`.

use super::layout::{CELLS, FULL, GOAL, GOAL_SCALE, MAP_WORDS, MAPS, ROW, real, whole};
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
            let (now, other) = maps[env * MAP_WORDS..][..MAP_WORDS].split_at(CELLS * ROW);
            for (i, seen) in row[GOAL..].chunks_exact_mut(4 * MAPS).enumerate() {
                let (now, other) = (now[i].to_le_bytes(), other[i].to_le_bytes());
                for (cell, seen) in seen.chunks_exact_mut(MAPS).enumerate() {
                    let share = |byte: u8| f32::from(byte) / f32::from(FULL);
                    (seen[0], seen[1]) = (share(now[cell]), share(other[cell]));
                }
            }
        }
    }
}
