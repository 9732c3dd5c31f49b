//! What the tasks `punch` and `joystick` add to the observation of the body. Shader:
//! `shaders/humanoid/punch_observe.wgsl`.

use super::punch_state::{FACING, HIT_STEPS, MOVING, PUNCH_STATE};
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::collision::poses_of;
use crate::kernels::physics::proprioception::{heading_of, in_heading_frame, unit};
use crate::kernels::physics::smooth_dynamics::spatial;
use crate::kernels::physics::strided::gather;
use crate::physics::pose::Pose;
use crate::physics::spatial::Spatial;
use glam::{Vec2, Vec3};

crate::shader_params! {
    pub struct Params for punch_observe {
        /// Environments of the batch.
        pub envs: u32,
        /// Index of the first number.
        pub at: u32,
        /// Numbers from one row to the next.
        pub width: u32,
        /// The environments to observe: those whose step ended as one of these, `1 << termination`.
        pub only: u32,
        /// Index of the velocities in what `smooth_dynamics` leaves.
        pub velocities_at: u32,
        /// Index of the target.
        pub target_body: u32,
        /// 1 if the wanted directions are observed.
        pub joystick: u32,
    }
}

/// Numbers that are added, for the joystick or not.
pub fn dim(joystick: bool) -> usize {
    if joystick { 23 } else { 19 }
}

/// Queues the shader on `gpu`.
///
/// `poses` is `[bodies * 7][envs]`, `dynamics` as `smooth_dynamics` leaves it, `task_state`
/// `[PUNCH_STATE][envs]`, `termination` `[envs]`; `observation` takes rows of `params.width`, from
/// `params.at` on, of each the first [`dim`] numbers.
pub fn launch(
    gpu: &Gpu,
    poses: &Buffer<f32>,
    dynamics: &Buffer<f32>,
    task_state: &Buffer<f32>,
    termination: &Buffer<u32>,
    observation: &Buffer<f32>,
    params: &Params,
) {
    gpu.launch(
        &shader::PUNCH_OBSERVE,
        groups(&shader::PUNCH_OBSERVE, params.envs as usize),
        &[poses, dynamics, task_state, termination, observation],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    poses: &[f32],
    dynamics: &[f32],
    task_state: &[f32],
    termination: &[u32],
    observation: &mut [f32],
    params: &Params,
) {
    let envs = params.envs as usize;
    let mut velocities = vec![0.0; 6 * (params.target_body as usize + 1)];
    let mut state = [0.0; PUNCH_STATE];
    for env in (0..envs).filter(|&env| params.only >> termination[env] & 1 == 1) {
        gather(
            dynamics,
            envs,
            env,
            params.velocities_at as usize,
            &mut velocities,
        );
        gather(task_state, envs, env, 0, &mut state);
        let velocities: Vec<Spatial> = velocities.chunks_exact(6).map(spatial).collect();
        let row = &mut observation[params.at as usize + env * params.width as usize..];
        let poses = poses_of(poses, envs, env);
        observe(&poses, &velocities, &state, row, params);
    }
}

/// Writes the [`dim`] numbers of a world whose bodies have these `poses` and `velocities`.
pub fn observe(
    poses: &[Pose],
    velocities: &[Spatial],
    state: &[f32],
    out: &mut [f32],
    params: &Params,
) {
    let target = params.target_body as usize;
    let (root, block) = (poses[0], poses[target]);
    let heading = heading_of(root.rotation);
    let gap = (block.position - root.position).truncate();
    let distance = gap.length();
    let is_hit = f32::from(u8::from(state[HIT_STEPS] > 0.0));
    let turned2 = |v: Vec2| [heading.dot(v), heading.x * v.y - heading.y * v.x];
    let turned3 = |v: Vec3| in_heading_frame(heading, v);
    let [x, y] = turned2(gap * (1.5 / distance.max(1e-6)).min(1.0));
    let velocity = velocities[target].linear - velocities[0].linear;
    let numbers = turned2(unit(gap))
        .into_iter()
        .chain([0.2 * distance, x, y, block.position.z, is_hit])
        .chain(turned3(block.rotation * Vec3::X))
        .chain(turned3(block.rotation * Vec3::Z))
        .chain(turned3(0.2 * velocity))
        .chain(turned3(0.2 * velocities[target].angular));
    let wanted = [MOVING, FACING].map(|at| turned2(Vec2::from_slice(&state[at..])));
    let wanted = wanted.concat().into_iter();
    let wanted = wanted.take(if params.joystick == 1 { 4 } else { 0 });
    out.iter_mut()
        .zip(numbers.chain(wanted))
        .for_each(|(out, number)| *out = number);
}
