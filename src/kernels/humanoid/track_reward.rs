//! Reward, measures and end of a step of the task `track`. Shader: `shaders/humanoid/track_reward.wgsl`.

use super::track_state::{LAST, ROW, TRACK_STATE};
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::collision::poses_of;
use crate::kernels::physics::strided::{gather, scatter};
use crate::kernels::termination::{FAILED, RUNNING, TRUNCATED};
use crate::physics::kinematics::quaternion;
use crate::physics::model::{JointKind, Model};
use crate::physics::pose::Pose;
use glam::Vec3;

crate::shader_params! {
    pub struct Params for track_reward {
        /// Environments of the batch.
        pub envs: u32,
        /// Index of the step's first reward.
        pub at: u32,
        /// Positions of a world.
        pub nq: u32,
        /// Velocities of a world.
        pub nv: u32,
        /// Index of the right hand.
        pub right_hand: u32,
        /// Index of the left hand.
        pub left_hand: u32,
        /// Index of the right foot.
        pub right_foot: u32,
        /// Index of the left foot.
        pub left_foot: u32,
        /// Largest distance of the root from its reference, m.
        pub max_distance: f32,
    }
}

/// Key bodies, whose positions are behind the positions and velocities of a reference.
pub const KEYS: usize = 4;
/// What is measured of a step: the distance of the root from its reference, m, and the mean distance of the key
/// bodies, m.
pub const MEASURES: usize = 2;

/// Queues the shader on `gpu`.
///
/// `state` is `[nq + nv][envs]` after the step, `poses` `[bodies * 7][envs]` of that state; `references`
/// `[rows][nq + nv + 3 * KEYS]`, `task_state` `[TRACK_STATE][envs]`; `reward` takes `[envs]` from `params.at` on,
/// `measures` `[MEASURES][envs]`, `task_end` `[envs]`.
pub fn launch(
    gpu: &Gpu,
    model_table: &Buffer<u32>,
    state: &Buffer<f32>,
    poses: &Buffer<f32>,
    references: &Buffer<f32>,
    task_state: &Buffer<f32>,
    reward: &Buffer<f32>,
    measures: &Buffer<f32>,
    task_end: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::TRACK_REWARD,
        groups(&shader::TRACK_REWARD, params.envs as usize),
        &[
            model_table,
            state,
            poses,
            references,
            task_state,
            reward,
            measures,
            task_end,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    model: &Model,
    state: &[f32],
    poses: &[f32],
    references: &[f32],
    task_state: &mut [f32],
    reward: &mut [f32],
    measures: &mut [f32],
    task_end: &mut [u32],
    params: &Params,
) {
    let envs = params.envs as usize;
    let mut positions = vec![0.0; params.nq as usize];
    let mut speeds = vec![0.0; params.nv as usize];
    let mut carried = [0.0; TRACK_STATE];
    let mut measured = [0.0; MEASURES];
    for env in 0..envs {
        gather(state, envs, env, 0, &mut positions);
        gather(state, envs, env, params.nq as usize, &mut speeds);
        gather(task_state, envs, env, 0, &mut carried);
        let body = TrackedBody {
            model,
            q: &positions,
            v: &speeds,
            poses: &poses_of(poses, envs, env),
        };
        let (gain, end) = step(&body, references, &mut carried, &mut measured, params);
        scatter(task_state, envs, env, 0, &carried);
        scatter(measures, envs, env, 0, &measured);
        reward[params.at as usize + env] = gain;
        task_end[env] = end;
    }
}

/// A body after a step.
pub struct TrackedBody<'a> {
    /// What it is of; its first tree is the body.
    pub model: &'a Model,
    /// `[nq]`
    pub q: &'a [f32],
    /// `[nv]`
    pub v: &'a [f32],
    /// `[bodies]`
    pub poses: &'a [Pose],
}

/// Reward of a step and how it ends for the task (Peng et al., "DeepMimic", 2018, equations 5 to 9, with the root in
/// place of the centre of mass).
pub fn step(
    body: &TrackedBody,
    references: &[f32],
    state: &mut [f32],
    measures: &mut [f32],
    params: &Params,
) -> (f32, u32) {
    state[ROW] += 1.0;
    let (nq, nv) = (params.nq as usize, params.nv as usize);
    let width = nq + nv + 3 * KEYS;
    let wanted = &references[state[ROW] as usize * width..][..width];
    let (q, rest) = wanted.split_at(nq);
    let (v, keys) = rest.split_at(nv);
    let bodies = [
        params.right_hand,
        params.left_hand,
        params.right_foot,
        params.left_foot,
    ];
    let distances = bodies
        .iter()
        .zip(keys.chunks_exact(3))
        .map(|(&key, wanted)| {
            let position = body.poses[key as usize].position;
            position.distance(Vec3::from_slice(wanted))
        });
    let distances: Vec<f32> = distances.collect();
    let key_error: f32 = distances.iter().map(|distance| distance * distance).sum();
    let root = Vec3::from_slice(body.q).distance(Vec3::from_slice(q));
    let reward = 0.65 * (-2.0 * pose_error(body.model, body.q, q)).exp()
        + 0.1 * (-0.1 * velocity_error(body.v, v)).exp()
        + 0.15 * (-40.0 * key_error).exp()
        + 0.1 * (-10.0 * root * root).exp();
    measures.copy_from_slice(&[root, distances.iter().sum::<f32>() / KEYS as f32]);
    let end = match (root > params.max_distance, state[ROW] >= state[LAST]) {
        (true, _) => FAILED,
        (false, true) => TRUNCATED,
        (false, false) => RUNNING,
    };
    (reward, end)
}

/// Squared differences of all joints' rotations, rad^2 (equation 6).
fn pose_error(model: &Model, q: &[f32], wanted: &[f32]) -> f32 {
    let errors = model.joints.iter().map(|joint| match joint.kind {
        JointKind::Free => 0.0,
        JointKind::Ball => {
            let [a, b] = [q, wanted].map(|q| quaternion(&q[joint.q..]).normalize());
            let angle = 2.0 * a.dot(b).abs().min(1.0).acos();
            angle * angle
        }
        JointKind::Hinge => (q[joint.q] - wanted[joint.q]).powi(2),
    });
    errors.sum()
}

/// Squared differences of all joints' velocities (equation 7).
fn velocity_error(v: &[f32], wanted: &[f32]) -> f32 {
    let pairs = v.iter().zip(wanted).skip(6);
    pairs.map(|(a, b)| (a - b) * (a - b)).sum()
}
