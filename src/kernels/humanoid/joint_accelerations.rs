//! How much the joints of two fighters were accelerated in a step. Shader:
//! `shaders/humanoid/joint_accelerations.wgsl`.

use super::boxing_state::{JOINT_SPEEDS, ROOT_DOFS, SQUARED_ACCELERATION, state_dim};
use super::fighters::FIGHTERS;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::strided::{gather, scatter};

crate::shader_params! {
    pub struct Params for joint_accelerations {
        /// Environments of the batch.
        pub envs: u32,
        /// Positions of a world.
        pub positions: u32,
        /// Degrees of freedom of a fighter.
        pub dofs: u32,
        /// Length of a step, s.
        pub dt: f32,
    }
}

/// Queues the shader on `gpu`.
///
/// `state` is `[nq + nv][envs]`, `task_state` `[state_dim][envs]`, see [`state_dim`].
pub fn launch(gpu: &Gpu, state: &Buffer<f32>, task_state: &Buffer<f32>, params: &Params) {
    let groups = groups(
        &shader::JOINT_ACCELERATIONS,
        FIGHTERS * params.envs as usize,
    );
    gpu.launch(
        &shader::JOINT_ACCELERATIONS,
        groups,
        &[state, task_state],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(state: &[f32], task_state: &mut [f32], params: &Params) {
    let (envs, dofs) = (params.envs as usize, params.dofs as usize);
    let mut v = vec![0.0; FIGHTERS * dofs];
    let mut carried = vec![0.0; state_dim(dofs)];
    for env in 0..envs {
        gather(state, envs, env, params.positions as usize, &mut v);
        gather(task_state, envs, env, 0, &mut carried);
        update(&v, &mut carried, params);
        scatter(task_state, envs, env, 0, &carried);
    }
}

/// Writes the sums of squared accelerations in a step after which the velocities of a world are `v`, `[nv]`, and remembers the speeds of
/// the joints.
pub fn update(v: &[f32], state: &mut [f32], params: &Params) {
    let (carried, before) = state.split_at_mut(JOINT_SPEEDS);
    let before = before.chunks_exact_mut(params.dofs as usize - ROOT_DOFS);
    let fighters = v.chunks_exact(params.dofs as usize).zip(before);
    for (sum, (v, before)) in carried[SQUARED_ACCELERATION..].iter_mut().zip(fighters) {
        let pairs = v[ROOT_DOFS..].iter().zip(&*before);
        let accelerations = pairs.map(|(now, before)| (now - before) / params.dt);
        *sum = accelerations
            .map(|acceleration| acceleration * acceleration)
            .sum();
        before.copy_from_slice(&v[ROOT_DOFS..]);
    }
}
