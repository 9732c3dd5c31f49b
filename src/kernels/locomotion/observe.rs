//! What the policy sees. Shader: `shaders/locomotion/observe.wgsl`.

use super::locomotion_layout::{
    BASE_OBS_DIM, CELLS, FULL, MAP_WORDS, MAPS, ROW, TARGET_SCALE, state_f32, state_u32,
};
use crate::gpu::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::character_frame::to_local;
use crate::motion::features::{POSE_DIM, ROW_STRIDE};

crate::shader_params! {
    pub struct Params for observe {
        /// Environments of the batch.
        pub envs: u32,
        /// Rows of an environment's maps; 1 without maps.
        pub rows: u32,
        /// Numbers of an observation.
        pub width: u32,
        /// Where this step's ends begin in `termination`.
        pub offset: u32,
        /// Write only the observations of environments that ended in one of these ways, `1 << end`.
        pub only: u32,
        /// The first observation to write.
        pub to: u32,
    }
}

/// Queues the shader on `gpu`.
///
/// `features` is `[frames][ROW_STRIDE]`, normalised; `state_f32` is `[state_f32::FIELDS][envs]`,
/// `state_u32` `[state_u32::FIELDS][envs]`; `termination` is `[envs]` from `params.offset` on,
/// `maps` `[envs][MAP_WORDS]`; `observation` takes `[envs][width]` from row `params.to` on.
pub fn launch(
    gpu: &Gpu,
    features: &Buffer<f32>,
    state_f32: &Buffer<f32>,
    state_u32: &Buffer<u32>,
    termination: &Buffer<u32>,
    maps: &Buffer<u32>,
    observation: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::OBSERVE, (params.envs * params.rows) as usize);
    gpu.launch(
        &shader::OBSERVE,
        groups,
        &[
            features,
            state_f32,
            state_u32,
            termination,
            maps,
            observation,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    features: &[[f32; ROW_STRIDE]],
    state_f32: &[f32],
    state_u32: &[u32],
    termination: &[u32],
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
        if params.only >> termination[params.offset as usize + env] & 1 == 0 {
            continue;
        }
        let at = |field: usize| state_f32[field * envs + env];
        let frame = state_u32[state_u32::FRAME * envs + env] as usize;
        row[..POSE_DIM].copy_from_slice(&features[frame][..POSE_DIM]);
        let offset = [
            at(state_f32::TARGET_X) - at(state_f32::X),
            at(state_f32::TARGET_Z) - at(state_f32::Z),
        ];
        let goal = to_local(offset, [at(state_f32::HEADING_X), at(state_f32::HEADING_Z)]);
        row[POSE_DIM] = goal[0] * TARGET_SCALE;
        row[POSE_DIM + 1] = goal[1] * TARGET_SCALE;
        if row.len() > BASE_OBS_DIM {
            let (now, other) = maps[env * MAP_WORDS..][..MAP_WORDS].split_at(CELLS * ROW);
            for (i, seen) in row[BASE_OBS_DIM..].chunks_exact_mut(4 * MAPS).enumerate() {
                let (now, other) = (now[i].to_le_bytes(), other[i].to_le_bytes());
                for (cell, seen) in seen.chunks_exact_mut(MAPS).enumerate() {
                    let share = |byte: u8| f32::from(byte) / f32::from(FULL);
                    (seen[0], seen[1]) = (share(now[cell]), share(other[cell]));
                }
            }
        }
    }
}
