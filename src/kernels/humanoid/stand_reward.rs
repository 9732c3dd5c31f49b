//! Reward of a step of the task `stand`. Shader: `shaders/humanoid/stand_reward.wgsl`.

use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::collision::poses_of;
use crate::kernels::physics::strided::gather;
use glam::Quat;

crate::shader_params! {
    pub struct Params for stand_reward {
        /// Environments of the batch.
        pub envs: u32,
        /// Index of the step's first reward.
        pub at: u32,
        /// Positions of a world.
        pub nq: u32,
        /// Velocities of a world.
        pub nv: u32,
        /// Index of the torso.
        pub torso: u32,
        /// Reward of every step.
        pub alive_reward: f32,
        /// Weight of [`uprightness`] in the reward.
        pub upright_reward: f32,
        /// Weight of [`stillness`] in the reward.
        pub stillness_reward: f32,
    }
}

/// Queues the shader on `gpu`.
///
/// `state` is `[nq + nv][envs]`, `poses` `[bodies * 7][envs]` of that state; `reward` takes `[envs]`
/// from `params.at` on, `measures` `[1][envs]`.
pub fn launch(
    gpu: &Gpu,
    state: &Buffer<f32>,
    poses: &Buffer<f32>,
    reward: &Buffer<f32>,
    measures: &Buffer<f32>,
    params: &Params,
) {
    gpu.launch(
        &shader::STAND_REWARD,
        groups(&shader::STAND_REWARD, params.envs as usize),
        &[state, poses, reward, measures],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    state: &[f32],
    poses: &[f32],
    reward: &mut [f32],
    measures: &mut [f32],
    params: &Params,
) {
    let envs = params.envs as usize;
    let mut v = vec![0.0; params.nv as usize];
    for env in 0..envs {
        gather(state, envs, env, params.nq as usize, &mut v);
        let torso = poses_of(poses, envs, env)[params.torso as usize].rotation;
        let upright = uprightness(torso);
        measures[env] = upright;
        reward[params.at as usize + env] = self::reward(upright, &v, params);
    }
}

/// Reward of a step that led to an uprightness and velocities `v`.
pub fn reward(upright: f32, v: &[f32], params: &Params) -> f32 {
    params.alive_reward + params.upright_reward * upright + params.stillness_reward * stillness(v)
}

/// How far the torso's up axis points up: 1 upright, -1 upside down.
pub fn uprightness(torso: Quat) -> f32 {
    1.0 - 2.0 * (torso.x * torso.x + torso.y * torso.y)
}

/// How little the joints move: 1 for those that stand still, falling with their mean square speed.
/// `v` is `[nv]`, the root's first.
pub fn stillness(v: &[f32]) -> f32 {
    let sum: f32 = v[6..].iter().map(|speed| speed * speed).sum();
    (-0.1 * sum / (v.len() - 6) as f32).exp()
}
