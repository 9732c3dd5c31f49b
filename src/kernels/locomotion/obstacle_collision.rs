//! Whether the character runs into an obstacle at any of the six frames of a step. Shader:
//! `shaders/locomotion/obstacle_collision.wgsl`.

use super::locomotion_layout::{VELOCITY_DIM, boxes, state_f32, state_u32};
use super::obstacles::{bounce, inside};
use crate::gpu::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::character_frame::{to_local, to_world};
use crate::motion::features::FRAMES_PER_STEP;
use rayon::prelude::*;

crate::shader_params! {
    pub struct Params for obstacle_collision {
        /// Environments of the batch.
        pub envs: u32,
        /// Obstacles of an environment.
        pub count: u32,
        /// Half the side of the square their centres stay in, m.
        pub square: f32,
        /// Seconds of a frame.
        pub frame_time: f32,
    }
}

/// Queues the shader on `gpu`.
///
/// `candidates` is `[candidates]`, the database frame of each; `matched` `[envs]`, the candidate
/// found by the search; `path` `[frames][4]`, the ground position (m) and heading of every frame in
/// its clip. `boxes` is `[envs][boxes::FIELDS][count]`, `obstacle_velocity`
/// `[envs][VELOCITY_DIM][count]`, both from before the step, as is `state_f32`,
/// `[state_f32::FIELDS][envs]`; of `state_u32`, `[state_u32::FIELDS][envs]`, `HAS_COLLIDED` is
/// written.
pub fn launch(
    gpu: &Gpu,
    candidates: &Buffer<u32>,
    matched: &Buffer<u32>,
    path: &Buffer<f32>,
    boxes: &Buffer<f32>,
    obstacle_velocity: &Buffer<f32>,
    state_f32: &Buffer<f32>,
    state_u32: &Buffer<u32>,
    params: &Params,
) {
    let groups = groups(&shader::OBSTACLE_COLLISION, params.envs as usize);
    gpu.launch(
        &shader::OBSTACLE_COLLISION,
        groups,
        &[
            candidates,
            matched,
            path,
            boxes,
            obstacle_velocity,
            state_f32,
            state_u32,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    candidates: &[u32],
    matched: &[u32],
    path: &[[f32; 4]],
    boxes: &[f32],
    obstacle_velocity: &[f32],
    state_f32: &[f32],
    state_u32: &mut [u32],
    params: &Params,
) {
    let (envs, count) = (params.envs as usize, params.count as usize);
    let found = state_u32[state_u32::HAS_COLLIDED * envs..][..envs].par_iter_mut();
    found
        .enumerate()
        .with_min_len(16)
        .for_each(|(env, struck)| {
            let r = |field: usize| state_f32[field * envs + env];
            let heading = [r(state_f32::HEADING_X), r(state_f32::HEADING_Z)];
            let frame = candidates[matched[env] as usize] as usize;
            let [x, z, hx, hz] = path[frame];
            let points: [[f32; 2]; FRAMES_PER_STEP] = std::array::from_fn(|k| {
                let next = path[frame + k + 1];
                let moved = to_world(to_local([next[0] - x, next[1] - z], [hx, hz]), heading);
                [r(state_f32::X) + moved[0], r(state_f32::Z) + moved[1]]
            });
            let boxes = &boxes[env * boxes::FIELDS * count..][..boxes::FIELDS * count];
            let obstacle_velocity =
                &obstacle_velocity[env * VELOCITY_DIM * count..][..VELOCITY_DIM * count];
            *struck = u32::from(
                (0..count).any(|slot| meets(&points, boxes, obstacle_velocity, slot, params)),
            );
        });
}

/// Whether one obstacle is where the character is at one of the six frames.
fn meets(
    points: &[[f32; 2]; FRAMES_PER_STEP],
    boxes: &[f32],
    obstacle_velocity: &[f32],
    slot: usize,
    params: &Params,
) -> bool {
    let count = params.count as usize;
    let half = [boxes::HALF_X, boxes::HALF_Z].map(|field| boxes[field * count + slot]);
    (0..FRAMES_PER_STEP).any(|k| {
        let time = (k + 1) as f32 * params.frame_time;
        let centre = [0, 1].map(|axis| {
            let at = axis * count + slot;
            bounce(boxes[at], obstacle_velocity[at], time, params.square).0
        });
        inside(points[k], centre, half)
    })
}
