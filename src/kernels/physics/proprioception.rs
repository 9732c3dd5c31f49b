//! What a character feels of itself. Shader: `shaders/body/proprioception.wgsl`.

use super::smooth_dynamics::{POSE, Sections, pose, spatial};
use super::strided::gather;
use crate::physics::kinematics::quaternion;
use crate::physics::model::{Kind, Model};
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};
use glam::{Quat, Vec2, Vec3};

crate::shader_params! {
    pub struct Params for proprioception {
        pub envs: u32,
        pub characters: u32,
        /// Numbers of a character, of all the same.
        pub width: u32,
    }
}

/// Numbers that a character of a tree feels, knowing the places of `keys` bodies.
pub fn width(model: &Model, tree: usize, keys: usize) -> usize {
    let joints = model.joints.iter();
    let own = joints.filter(|joint| model.bodies[joint.body].tree == tree);
    let numbers = own.map(|joint| match joint.kind {
        Kind::Free => 0,
        Kind::Ball => 6 + 3,
        Kind::Hinge => 1 + 1,
    });
    // Height, turn, velocity and angular velocity of the root, free or not.
    1 + 6 + 3 + 3 + numbers.sum::<usize>() + 3 * keys
}

#[allow(clippy::too_many_arguments)]
pub fn launch(
    gpu: &Gpu,
    tables: &Buffer<u32>,
    state: &Buffer<f32>,
    poses: &Buffer<f32>,
    dynamics: &Buffer<f32>,
    characters: &Buffer<u32>,
    felt: &Buffer<f32>,
    params: &Params,
) {
    let numbers = (params.characters * params.envs * params.width) as usize;
    assert_eq!(felt.len(), numbers, "what all characters feel");
    gpu.launch(
        &shader::PROPRIOCEPTION,
        groups(
            &shader::PROPRIOCEPTION,
            (params.characters * params.envs) as usize,
        ),
        &[tables, state, poses, dynamics, characters, felt],
        params,
    );
}

pub fn twin(
    model: &Model,
    state: &[f32],
    poses: &[f32],
    dynamics: &[f32],
    characters: &[u32],
    felt: &mut [f32],
    params: &Params,
) {
    let envs = params.envs as usize;
    let velocities = Sections::of(model).velocities;
    let (mut q, mut v) = (vec![0.0; model.positions()], vec![0.0; model.dofs.len()]);
    let (&keys, lists) = characters.split_first().expect("how many keys");
    let lists = lists.chunks_exact(1 + keys as usize);
    for (character, list) in lists.enumerate() {
        let tree = &model.trees[list[0] as usize];
        let root = tree.bodies.start;
        for env in 0..envs {
            gather(state, envs, env, 0, &mut q);
            gather(state, envs, env, model.positions(), &mut v);
            let mut numbers = [0.0; 6];
            gather(dynamics, envs, env, velocities + 6 * root, &mut numbers);
            let motion = spatial(&numbers);
            let place = |body: usize| {
                let mut numbers = [0.0; POSE];
                gather(poses, envs, env, POSE * body, &mut numbers);
                pose(&numbers)
            };
            let root = place(root);
            let forward = (root.turn * Vec3::X).truncate();
            let heading = match forward.length() > 1e-6 {
                true => forward / forward.length(),
                false => Vec2::X,
            };
            let mut feels = vec![root.place.z];
            feels.extend(turn(root.turn, heading));
            feels.extend(ahead(heading, motion.linear).to_array());
            feels.extend(ahead(heading, motion.angular).to_array());
            for joint in &model.joints {
                if !tree.dofs.contains(&joint.v) {
                    continue;
                }
                match joint.kind {
                    Kind::Free => {}
                    Kind::Ball => {
                        feels.extend(turn(quaternion(&q[joint.q..]).normalize(), Vec2::X))
                    }
                    Kind::Hinge => feels.push(q[joint.q]),
                }
            }
            let free = model.joints[model.bodies[tree.bodies.start].joints.clone()].first();
            let skip = free.map_or(0, |joint| if joint.kind == Kind::Free { 6 } else { 0 });
            feels.extend(&v[tree.dofs.start + skip..tree.dofs.end]);
            let below = Vec3::new(root.place.x, root.place.y, 0.0);
            for &body in &list[1..] {
                feels.extend(ahead(heading, place(body as usize).place - below).to_array());
            }
            let width = params.width as usize;
            felt[(character * envs + env) * width..][..width].copy_from_slice(&feels);
        }
    }
}

/// A vector of the world in the heading frame.
fn ahead(heading: Vec2, vector: Vec3) -> Vec3 {
    Vec3::new(
        heading.x * vector.x + heading.y * vector.y,
        heading.x * vector.y - heading.y * vector.x,
        vector.z,
    )
}

/// Where a turn takes the axes x and z.
fn turn(turn: Quat, heading: Vec2) -> impl Iterator<Item = f32> {
    let axes = [Vec3::X, Vec3::Z].map(|axis| ahead(heading, turn * axis).to_array());
    axes.into_iter().flatten()
}
