//! Asked-for positions that lie in an obstacle (paper, equation 5). Shader:
//! `shaders/world/hits.wgsl`.

use super::layout::{boxes, real, whole};
use super::obstacles::inside;
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::features::TRAJECTORY;
use crate::motion::frame::to_world;
use rayon::prelude::*;

crate::shader_params! {
    pub struct Params for hits {
        pub envs: u32,
        /// Obstacles of an environment.
        pub count: u32,
    }
}

const ASKED: usize = 3;

pub fn launch(
    gpu: &Gpu,
    action: &Buffer<f32>,
    normal: &Buffer<f32>,
    boxes: &Buffer<f32>,
    real: &Buffer<f32>,
    whole: &Buffer<u32>,
    params: &Params,
) {
    let groups = groups(&shader::HITS, params.envs as usize);
    gpu.launch(
        &shader::HITS,
        groups,
        &[action, normal, boxes, real, whole],
        params,
    );
}

pub fn twin(
    action: &[f32],
    normal: &[f32],
    boxes: &[f32],
    real: &[f32],
    whole: &mut [u32],
    params: &Params,
) {
    let (envs, count) = (params.envs as usize, params.count as usize);
    let found = whole[whole::HITS * envs..][..envs].par_iter_mut();
    found.enumerate().with_min_len(16).for_each(|(env, hits)| {
        let r = |field: usize| real[field * envs + env];
        let heading = [r(real::HEADING_X), r(real::HEADING_Z)];
        let boxes = &boxes[env * boxes::FIELDS * count..][..boxes::FIELDS * count];
        let hit = |k: &usize| {
            let asked = [4 * k, 4 * k + 1]
                .map(|i| action[env * TRAJECTORY + i] / normal[TRAJECTORY + i] + normal[i]);
            let moved = to_world(asked, heading);
            let point = [r(real::X) + moved[0], r(real::Z) + moved[1]];
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
