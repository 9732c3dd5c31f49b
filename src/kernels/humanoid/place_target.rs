//! Stands the target of the tasks `punch` and `joystick` around the character. Shader:
//! `shaders/humanoid/place_target.wgsl`.

use super::punch_state::{FACING, FIRST, FIRST_SPEED, HIT_STEPS, MOVING, PUNCH_STATE};
use crate::gpu::shader::place_target::constants::STREAM;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::strided::{gather, scatter};
use crate::kernels::rng::{random4, uniform01};
use glam::Vec2;
use std::f32::consts::PI;

crate::shader_params! {
    pub struct Params for place_target {
        /// Environments of the batch.
        pub envs: u32,
        /// Number of the first environment in the whole batch.
        pub first: u32,
        /// Seed of the random numbers.
        pub seed: u32,
        /// Their counter, another for every reset.
        pub step_counter: u32,
        /// Positions of a world.
        pub nq: u32,
        /// First position of the target's free joint.
        pub target_q: u32,
        /// First velocity of the target's free joint.
        pub target_v: u32,
        /// Fraction of the targets that are near.
        pub near_share: f32,
        /// Least distance of these, m.
        pub near_least: f32,
        /// Largest distance of these, m.
        pub near_most: f32,
        /// Largest bearing of these from the character's heading, rad.
        pub near_bearing: f32,
        /// Least distance of the others, m.
        pub least: f32,
        /// Largest distance of the others, m.
        pub most: f32,
        /// Height of the target's centre, m.
        pub height: f32,
        /// 1 if the wanted facing is any, more if it is the more often near the way.
        pub facing_power: f32,
    }
}

/// Queues the shader on `gpu`.
///
/// `mask` is `[envs]`, not 0 where an episode begins; `starts` `[nq + nv][envs]`, `task_state`
/// `[PUNCH_STATE][envs]`.
pub fn launch(
    gpu: &Gpu,
    mask: &Buffer<u32>,
    starts: &Buffer<f32>,
    task_state: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::PLACE_TARGET, params.envs as usize);
    let buffers: [&dyn crate::gpu::Argument; 3] = [mask, starts, task_state];
    gpu.launch(&shader::PLACE_TARGET, groups, &buffers, params);
}

/// The shader's computation on the host.
pub fn twin(mask: &[u32], starts: &mut [f32], task_state: &mut [f32], params: &Params) {
    let envs = params.envs as usize;
    let mut start = vec![0.0; starts.len() / envs];
    let mut state = [0.0; PUNCH_STATE];
    for env in (0..envs).filter(|&env| mask[env] != 0) {
        gather(starts, envs, env, 0, &mut start);
        place(env, &mut start, &mut state, params);
        scatter(starts, envs, env, 0, &start);
        scatter(task_state, envs, env, 0, &state);
    }
}

/// Stands the target into a start state, `[nq + nv]`, and says where the character is to face and to move.
pub fn place(env: usize, start: &mut [f32], state: &mut [f32], params: &Params) {
    let key = params.first + env as u32;
    let bits = random4(params.seed, key, params.step_counter, STREAM);
    let [facing, ..] = random4(params.seed, key, params.step_counter, STREAM + 1);
    let [lot, spread, distance, yaw] = bits.map(uniform01);
    let near = lot < params.near_share;
    let (bearing, [least, most]) = match near {
        true => (params.near_bearing, [params.near_least, params.near_most]),
        false => (PI, [params.least, params.most]),
    };
    let bearing = heading(start) + (2.0 * spread - 1.0) * bearing;
    let distance = least + (most - least) * distance;
    let (sin, cos) = bearing.sin_cos();
    let (half_sin, half_cos) = (PI * yaw).sin_cos();
    let [x, y] = [start[0] + distance * cos, start[1] + distance * sin];
    let q = params.target_q as usize;
    start[q..q + 7].copy_from_slice(&[x, y, params.height, half_cos, 0.0, 0.0, half_sin]);
    start[(params.nq + params.target_v) as usize..][..6].fill(0.0);
    state.fill(0.0);
    let turn = 2.0 * uniform01(facing) - 1.0;
    let turn = PI * turn.signum() * turn.abs().powf(params.facing_power);
    let (facing_sin, facing_cos) = (bearing + turn).sin_cos();
    state[FACING..FACING + 2].copy_from_slice(&[facing_cos, facing_sin]);
    state[MOVING..MOVING + 2].copy_from_slice(&[cos, sin]);
}

/// Stands the target upright at a point of the ground, m, as if it had never been hit.
pub fn stand_at(at: [f32; 2], q: &mut [f32], v: &mut [f32], state: &mut [f32], params: &Params) {
    let way = Vec2::from(at) - Vec2::new(q[0], q[1]);
    let first = params.target_q as usize;
    q[first..first + 7].copy_from_slice(&[at[0], at[1], params.height, 1.0, 0.0, 0.0, 0.0]);
    v[params.target_v as usize..][..6].fill(0.0);
    state[MOVING..MOVING + 2].copy_from_slice(&way.normalize_or(Vec2::X).to_array());
    for touched in [HIT_STEPS, FIRST, FIRST_SPEED] {
        state[touched] = 0.0;
    }
}

/// Which way the root faces on the ground, rad.
fn heading(start: &[f32]) -> f32 {
    let [w, x, y, z] = [3, 4, 5, 6].map(|at| start[at]);
    (2.0 * (x * y + w * z)).atan2(1.0 - 2.0 * (y * y + z * z))
}
