//! A character's observation of its own body. Shader: `shaders/physics/proprioception.wgsl`.

use super::collision::poses_of;
use super::smooth_dynamics::{DynamicsLayout, spatial};
use super::strided::gather;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::physics::kinematics::quaternion;
use crate::physics::model::{JointKind, Model};
use crate::physics::pose::Pose;
use crate::physics::spatial::Spatial;
use glam::{Quat, Vec2, Vec3};

crate::shader_params! {
    pub struct Params for proprioception {
        /// Environments of the batch.
        pub envs: u32,
        /// Characters of an environment.
        pub characters: u32,
        /// Numbers of an observation.
        pub width: u32,
        /// Index of the first observation.
        pub at: u32,
        /// The environments to observe: those whose step ended as one of these, `1 << termination`.
        pub only: u32,
    }
}

/// Index of the root's velocity in the heading frame, m/s: after its height and rotation.
pub const ROOT_VELOCITY: usize = 1 + 6;
/// Index of its angular velocity there, rad/s.
pub const ROOT_ANGULAR_VELOCITY: usize = ROOT_VELOCITY + 3;

/// Numbers of the observation of a tree's character with `keys` key bodies.
pub fn width(model: &Model, tree: usize, keys: usize) -> usize {
    let joints = model.joints.iter();
    let own = joints.filter(|joint| model.bodies[joint.body].tree == tree);
    let numbers = own.map(|joint| match joint.kind {
        JointKind::Free => 0,
        JointKind::Ball => 6 + 3,
        JointKind::Hinge => 1 + 1,
    });
    // The root's, free or not, come first.
    ROOT_ANGULAR_VELOCITY + 3 + numbers.sum::<usize>() + 3 * keys
}

/// Queues the shader on `gpu`.
///
/// `poses` and the velocities in `dynamics` must be of `state`. `characters` holds the number of key
/// bodies, then of each character its tree and its key bodies; `termination` `[envs]`; `observation`
/// takes `[envs][characters][width]` from `params.at` on, of which each row's own numbers come first.
pub fn launch(
    gpu: &Gpu,
    tables: &Buffer<u32>,
    state: &Buffer<f32>,
    poses: &Buffer<f32>,
    dynamics: &Buffer<f32>,
    characters: &Buffer<u32>,
    termination: &Buffer<u32>,
    observation: &Buffer<f32>,
    params: &Params,
) {
    let rows = params.characters * params.envs;
    let end = (params.at + rows * params.width) as usize;
    assert!(observation.len() >= end, "observations of all characters");
    gpu.launch(
        &shader::PROPRIOCEPTION,
        groups(&shader::PROPRIOCEPTION, rows as usize),
        &[
            tables,
            state,
            poses,
            dynamics,
            characters,
            termination,
            observation,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    model: &Model,
    state: &[f32],
    poses: &[f32],
    dynamics: &[f32],
    characters: &[u32],
    termination: &[u32],
    observation: &mut [f32],
    params: &Params,
) {
    let envs = params.envs as usize;
    let (mut q, mut v) = (vec![0.0; model.nq()], vec![0.0; model.dofs.len()]);
    let mut velocities = vec![0.0; 6 * model.bodies.len()];
    let (&keys, lists) = characters.split_first().expect("how many keys");
    let rows = observation[params.at as usize..].chunks_exact_mut(params.width as usize);
    for (row, out) in rows.take(envs * params.characters as usize).enumerate() {
        let (env, character) = (
            row / params.characters as usize,
            row % params.characters as usize,
        );
        if params.only >> termination[env] & 1 == 0 {
            continue;
        }
        gather(state, envs, env, 0, &mut q);
        gather(state, envs, env, model.nq(), &mut v);
        let from = DynamicsLayout::new(model).velocities;
        gather(dynamics, envs, env, from, &mut velocities);
        let velocities: Vec<Spatial> = velocities.chunks_exact(6).map(spatial).collect();
        let character = &lists[character * (1 + keys as usize)..][..1 + keys as usize];
        let poses = poses_of(poses, envs, env);
        observe(model, &q, &v, &poses, &velocities, character, out);
    }
}

/// Writes the observation `[width]` of a character, its tree and then its key bodies, in a world with
/// positions `q`, velocities `v`, and the `poses` and `velocities` of bodies that follow from them.
pub fn observe(
    model: &Model,
    q: &[f32],
    v: &[f32],
    poses: &[Pose],
    velocities: &[Spatial],
    character: &[u32],
    out: &mut [f32],
) {
    let tree = &model.trees[character[0] as usize];
    let (root, velocity) = (&poses[tree.bodies.start], velocities[tree.bodies.start]);
    let heading = heading_of(root.rotation);
    let mut rest = out;
    let mut put = |values: &[f32]| {
        let (now, then) = std::mem::take(&mut rest).split_at_mut(values.len());
        now.copy_from_slice(values);
        rest = then;
    };
    put(&[root.position.z]);
    put(&rotation(root.rotation, heading));
    put(&in_heading_frame(heading, velocity.linear));
    put(&in_heading_frame(heading, velocity.angular));
    for joint in &model.joints {
        if !tree.dofs.contains(&joint.v) {
            continue;
        }
        match joint.kind {
            JointKind::Free => {}
            JointKind::Ball => put(&rotation(quaternion(&q[joint.q..]).normalize(), Vec2::X)),
            JointKind::Hinge => put(&[q[joint.q]]),
        }
    }
    let first = model.joints[model.bodies[tree.bodies.start].joints.clone()].first();
    let free = first.is_some_and(|joint| joint.kind == JointKind::Free);
    put(&v[tree.dofs.start + if free { 6 } else { 0 }..tree.dofs.end]);
    let below = Vec3::new(root.position.x, root.position.y, 0.0);
    for &body in &character[1..] {
        put(&in_heading_frame(
            heading,
            poses[body as usize].position - below,
        ));
    }
}

/// Which way a root faces on the ground, a unit vector; one that faces straight up or down has no heading, and
/// gets the world's.
pub fn heading_of(root: Quat) -> Vec2 {
    unit((root * Vec3::X).truncate())
}

/// A vector as a unit vector, x if it is none.
pub fn unit(v: Vec2) -> Vec2 {
    match v.length() > 1e-6 {
        true => v / v.length(),
        false => Vec2::X,
    }
}

/// A vector of the world in the heading frame.
pub fn in_heading_frame(heading: Vec2, vector: Vec3) -> [f32; 3] {
    [
        heading.x * vector.x + heading.y * vector.y,
        heading.x * vector.y - heading.y * vector.x,
        vector.z,
    ]
}

/// Where a rotation takes the axes x and z.
pub fn rotation(rotation: Quat, heading: Vec2) -> [f32; 6] {
    let [x, z] = [Vec3::X, Vec3::Z].map(|axis| in_heading_frame(heading, rotation * axis));
    [x[0], x[1], x[2], z[0], z[1], z[2]]
}
