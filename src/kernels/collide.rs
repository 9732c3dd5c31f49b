//! Whether the character runs into an obstacle at any of the six frames of a step. Shader:
//! `shaders/world/collide.wgsl`.

use super::layout::{AXES, boxes, real, whole};
use super::obstacles::{bounce, inside};
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::features::PLAYED;
use crate::motion::frame::{to_local, to_world};
use rayon::prelude::*;

crate::shader_params! {
    pub struct Params for collide {
        pub envs: u32,
        /// Obstacles of an environment.
        pub count: u32,
        /// Half the side of the square their centres stay in, m.
        pub square: f32,
        /// Seconds of a frame.
        pub frame_time: f32,
    }
}

pub fn launch(
    gpu: &Gpu,
    candidates: &Buffer<u32>,
    matched: &Buffer<u32>,
    path: &Buffer<f32>,
    boxes: &Buffer<f32>,
    drift: &Buffer<f32>,
    real: &Buffer<f32>,
    whole: &Buffer<u32>,
    params: &Params,
) {
    let groups = groups(&shader::COLLIDE, params.envs as usize);
    gpu.launch(
        &shader::COLLIDE,
        groups,
        &[candidates, matched, path, boxes, drift, real, whole],
        params,
    );
}

pub fn twin(
    candidates: &[u32],
    matched: &[u32],
    path: &[[f32; 4]],
    boxes: &[f32],
    drift: &[f32],
    real: &[f32],
    whole: &mut [u32],
    params: &Params,
) {
    let (envs, count) = (params.envs as usize, params.count as usize);
    let found = whole[whole::STRUCK * envs..][..envs].par_iter_mut();
    found
        .enumerate()
        .with_min_len(16)
        .for_each(|(env, struck)| {
            let r = |field: usize| real[field * envs + env];
            let heading = [r(real::HEADING_X), r(real::HEADING_Z)];
            let frame = candidates[matched[env] as usize] as usize;
            let [x, z, hx, hz] = path[frame];
            let points: [[f32; 2]; PLAYED] = std::array::from_fn(|k| {
                let next = path[frame + k + 1];
                let moved = to_world(to_local([next[0] - x, next[1] - z], [hx, hz]), heading);
                [r(real::X) + moved[0], r(real::Z) + moved[1]]
            });
            let boxes = &boxes[env * boxes::FIELDS * count..][..boxes::FIELDS * count];
            let drift = &drift[env * AXES * count..][..AXES * count];
            *struck = u32::from((0..count).any(|slot| meets(&points, boxes, drift, slot, params)));
        });
}

/// Whether one obstacle is where the character is at one of the six frames.
fn meets(
    points: &[[f32; 2]; PLAYED],
    boxes: &[f32],
    drift: &[f32],
    slot: usize,
    params: &Params,
) -> bool {
    let count = params.count as usize;
    let half = [boxes::HALF_X, boxes::HALF_Z].map(|field| boxes[field * count + slot]);
    (0..PLAYED).any(|k| {
        let time = (k + 1) as f32 * params.frame_time;
        let centre = [0, 1].map(|axis| {
            let at = axis * count + slot;
            bounce(boxes[at], drift[at], time, params.square).0
        });
        inside(points[k], centre, half)
    })
}
