//! What the task `track` adds to the observation of the body: where it should be a step on. Shader:
//! `shaders/humanoid/track_observe.wgsl`.

use super::track_reward::KEYS;
use super::track_state::{LAST, ROW, TRACK_STATE};
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::collision::poses_of;
use crate::kernels::physics::proprioception::{heading_of, in_heading_frame, rotation};
use crate::kernels::physics::strided::gather;
use crate::physics::kinematics::quaternion;
use crate::physics::model::{JointKind, Model};
use crate::physics::pose::Pose;
use glam::{Vec2, Vec3};

crate::shader_params! {
    pub struct Params for track_observe {
        /// Environments of the batch.
        pub envs: u32,
        /// Index of the first number.
        pub at: u32,
        /// Numbers from one row to the next.
        pub width: u32,
        /// The environments to observe: those whose step ended as one of these, `1 << termination`.
        pub only: u32,
        /// Positions of a world.
        pub nq: u32,
        /// Velocities of a world.
        pub nv: u32,
    }
}

/// Numbers that are added, of a model that is one body.
pub fn dim(model: &Model) -> usize {
    let joints = model.joints.iter().map(|joint| match joint.kind {
        JointKind::Free => 0,
        JointKind::Ball => 6 + 3,
        JointKind::Hinge => 1 + 1,
    });
    3 + 6 + joints.sum::<usize>()
}

/// Queues the shader on `gpu`.
///
/// `poses` is `[bodies * 7][envs]`, `references` `[rows][nq + nv + 3 * KEYS]`, `task_state` `[TRACK_STATE][envs]`,
/// `termination` `[envs]`; `observation` takes rows of `params.width`, from `params.at` on, of each the first
/// [`dim`] numbers.
pub fn launch(
    gpu: &Gpu,
    model_table: &Buffer<u32>,
    poses: &Buffer<f32>,
    references: &Buffer<f32>,
    task_state: &Buffer<f32>,
    termination: &Buffer<u32>,
    observation: &Buffer<f32>,
    params: &Params,
) {
    gpu.launch(
        &shader::TRACK_OBSERVE,
        groups(&shader::TRACK_OBSERVE, params.envs as usize),
        &[
            model_table,
            poses,
            references,
            task_state,
            termination,
            observation,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    model: &Model,
    poses: &[f32],
    references: &[f32],
    task_state: &[f32],
    termination: &[u32],
    observation: &mut [f32],
    params: &Params,
) {
    let envs = params.envs as usize;
    let mut state = [0.0; TRACK_STATE];
    for env in (0..envs).filter(|&env| params.only >> termination[env] & 1 == 1) {
        gather(task_state, envs, env, 0, &mut state);
        let row = &mut observation[params.at as usize + env * params.width as usize..];
        let root = poses_of(poses, envs, env)[0];
        observe(model, root, references, &state, row, params);
    }
}

/// Writes the [`dim`] numbers of a world whose root is there.
pub fn observe(
    model: &Model,
    root: Pose,
    references: &[f32],
    state: &[f32],
    out: &mut [f32],
    params: &Params,
) {
    let (nq, nv) = (params.nq as usize, params.nv as usize);
    let next = (state[ROW] + 1.0).min(state[LAST]) as usize;
    let wanted = &references[next * (nq + nv + 3 * KEYS)..];
    let heading = heading_of(root.rotation);
    let mut rest = out;
    let mut put = |values: &[f32]| {
        let (now, then) = std::mem::take(&mut rest).split_at_mut(values.len());
        now.copy_from_slice(values);
        rest = then;
    };
    let turn = |at: usize| quaternion(&wanted[at..]).normalize();
    put(&in_heading_frame(
        heading,
        Vec3::from_slice(wanted) - root.position,
    ));
    put(&rotation(turn(3), heading));
    for joint in &model.joints {
        match joint.kind {
            JointKind::Free => {}
            JointKind::Ball => put(&rotation(turn(joint.q), Vec2::X)),
            JointKind::Hinge => put(&[wanted[joint.q]]),
        }
    }
    put(&wanted[nq + 6..nq + nv]);
}
