//! Asked-for positions that lie in an obstacle (paper, equation 5). Shader:
//! `shaders/locomotion/hits.wgsl`.

use super::locomotion_layout::{boxes, state_f32, state_u32};
use super::obstacles::inside;
use crate::gpu::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::character_frame::to_world;
use crate::motion::features::TRAJECTORY_DIM;
use rayon::prelude::*;

crate::shader_params! {
    pub struct Params for hits {
        /// Environments of the batch.
        pub envs: u32,
        /// Where the first number of the actions is.
        pub action_at: u32,
        /// Obstacles of an environment.
        pub count: u32,
    }
}

const ASKED: usize = 3;

/// Queues the shader on `gpu`.
///
/// `action` is `[envs][TRAJECTORY_DIM]` from `params.action_at` on, normalised; `normal`
/// `[2][TRAJECTORY_DIM]`, mean and scale of the trajectory features: a feature is
/// `action / scale + mean`. `boxes` is `[envs][boxes::FIELDS][count]`, `state_f32`
/// `[state_f32::FIELDS][envs]`; of `state_u32`, `[state_u32::FIELDS][envs]`, `HITS` is written.
pub fn launch(
    gpu: &Gpu,
    action: &Buffer<f32>,
    normal: &Buffer<f32>,
    boxes: &Buffer<f32>,
    state_f32: &Buffer<f32>,
    state_u32: &Buffer<u32>,
    params: &Params,
) {
    let groups = groups(&shader::HITS, params.envs as usize);
    gpu.launch(
        &shader::HITS,
        groups,
        &[action, normal, boxes, state_f32, state_u32],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    action: &[f32],
    normal: &[f32],
    boxes: &[f32],
    state_f32: &[f32],
    state_u32: &mut [u32],
    params: &Params,
) {
    let (envs, count) = (params.envs as usize, params.count as usize);
    let found = state_u32[state_u32::HITS * envs..][..envs].par_iter_mut();
    found.enumerate().with_min_len(16).for_each(|(env, hits)| {
        let r = |field: usize| state_f32[field * envs + env];
        let heading = [r(state_f32::HEADING_X), r(state_f32::HEADING_Z)];
        let boxes = &boxes[env * boxes::FIELDS * count..][..boxes::FIELDS * count];
        let hit = |k: &usize| {
            let asked = [4 * k, 4 * k + 1].map(|i| {
                action[params.action_at as usize + env * TRAJECTORY_DIM + i]
                    / normal[TRAJECTORY_DIM + i]
                    + normal[i]
            });
            let moved = to_world(asked, heading);
            let point = [r(state_f32::X) + moved[0], r(state_f32::Z) + moved[1]];
            obstructed(point, boxes, count)
        };
        *hits = (0..ASKED).filter(hit).count() as u32;
    });
}

/// Whether a point lies in any of an environment's boxes `[boxes::FIELDS][count]`.
pub fn obstructed(point: [f32; 2], boxes: &[f32], count: usize) -> bool {
    let field = |field: usize| &boxes[field * count..][..count];
    let (x, z) = (field(boxes::X), field(boxes::Z));
    let (half_x, half_z) = (field(boxes::HALF_X), field(boxes::HALF_Z));
    (0..count).any(|i| inside(point, [x[i], z[i]], [half_x[i], half_z[i]]))
}
