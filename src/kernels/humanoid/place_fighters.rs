//! Stands two fighters on opposite sides of an arena's centre. Shader:
//! `shaders/humanoid/place_fighters.wgsl`.

use super::boxing_state::{JOINT_SPEEDS, ROOT_DOFS, state_dim};
use super::fighters::FIGHTERS;
use crate::gpu::shader::place_fighters::constants::STREAM;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::strided::{gather, scatter};
use crate::kernels::rng::{random4, uniform01};
use crate::physics::kinematics::{quaternion, store};
use glam::{Quat, Vec2};
use std::f32::consts::PI;

crate::shader_params! {
    pub struct Params for place_fighters {
        /// Environments of the batch.
        pub envs: u32,
        /// Number of the first environment in the whole batch.
        pub first: u32,
        /// Seed of the random numbers.
        pub seed: u32,
        /// Their counter, another for every reset.
        pub step_counter: u32,
        /// Positions of a fighter.
        pub positions: u32,
        /// Degrees of freedom of a fighter.
        pub dofs: u32,
        /// Half the width of the arena, m.
        pub arena: f32,
        /// Least distance from its centre, m.
        pub least: f32,
        /// Largest distance from its centre, m.
        pub most: f32,
    }
}

/// Distance of starts from the border, m: who began on it would be out in a step.
pub const MARGIN: f32 = 0.25;

/// Queues the shader on `gpu`.
///
/// `mask` is `[envs]`, not 0 where an episode begins; `starts` `[nq + nv][envs]`: the positions of one fighter and
/// the other, then their velocities; `task_state` `[state_dim][envs]`, see [`state_dim`].
pub fn launch(
    gpu: &Gpu,
    mask: &Buffer<u32>,
    starts: &Buffer<f32>,
    task_state: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::PLACE_FIGHTERS, params.envs as usize);
    let buffers: [&dyn crate::gpu::Argument; 3] = [mask, starts, task_state];
    gpu.launch(&shader::PLACE_FIGHTERS, groups, &buffers, params);
}

/// The shader's computation on the host.
pub fn twin(mask: &[u32], starts: &mut [f32], task_state: &mut [f32], params: &Params) {
    let envs = params.envs as usize;
    let (positions, dofs) = (params.positions as usize, params.dofs as usize);
    let mut start = vec![0.0; FIGHTERS * (positions + dofs)];
    let mut state = vec![0.0; state_dim(dofs)];
    for env in (0..envs).filter(|&env| mask[env] != 0) {
        gather(starts, envs, env, 0, &mut start);
        place(env, &mut start, &mut state, params);
        scatter(starts, envs, env, 0, &start);
        scatter(task_state, envs, env, 0, &state);
    }
}

/// Places both fighters of a start state, `[nq + nv]`, and begins the bout that `state` is of.
pub fn place(env: usize, start: &mut [f32], state: &mut [f32], params: &Params) {
    let key = params.first + env as u32;
    let bits = random4(params.seed, key, params.step_counter, STREAM);
    let [more, ..] = random4(params.seed, key, params.step_counter, STREAM + 1);
    let [bearing, red, blue, red_yaw] = bits.map(uniform01);
    let way = Vec2::from_angle(2.0 * PI * bearing);
    let edge = Vec2::splat(params.arena - MARGIN);
    let at = |part: f32| params.least + (params.most - params.least) * part;
    let spots = [at(red) * way, at(blue) * -way].map(|spot| spot.clamp(-edge, edge));
    let yaws = [red_yaw, uniform01(more)];
    let dofs = params.dofs as usize;
    let (q, v) = start.split_at_mut(FIGHTERS * params.positions as usize);
    let fighters = q.chunks_exact_mut(params.positions as usize);
    for (fighter, (q, v)) in fighters.zip(v.chunks_exact_mut(dofs)).enumerate() {
        stand(q, v, spots[fighter], 2.0 * PI * yaws[fighter]);
    }
    state[..JOINT_SPEEDS].fill(0.0);
    let before = state[JOINT_SPEEDS..].chunks_exact_mut(dofs - ROOT_DOFS);
    for (before, v) in before.zip(v.chunks_exact(dofs)) {
        before.copy_from_slice(&v[ROOT_DOFS..]);
    }
}

/// Turns a fighter about the vertical by `yaw` rad, and stands it `at` a point of the ground, m. Its angular velocity
/// turns with it.
fn stand(q: &mut [f32], v: &mut [f32], at: Vec2, yaw: f32) {
    q[..2].copy_from_slice(&at.to_array());
    let rotation = Quat::from_rotation_z(yaw) * quaternion(&q[3..]);
    store(&mut q[3..], rotation);
    let speed = Vec2::from_angle(yaw).rotate(Vec2::from_slice(v));
    v[..2].copy_from_slice(&speed.to_array());
}
