//! Poses, factors of the mass matrix and unconstrained acceleration of articulated bodies. Shader:
//! `shaders/body/articulate.wgsl`.

use super::strided::{gather, scatter};
use crate::physics::model::Model;
use crate::physics::simulator::{Physics, State};
use crate::physics::pose::Pose;
use crate::physics::spatial::Spatial;
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};
use glam::{Quat, Vec3};

crate::shader_params! {
    pub struct Params for smooth_dynamics {
        pub envs: u32,
        /// Seconds of a step.
        pub dt: f32,
    }
}

/// Numbers of a pose: place, quaternion x y z w.
pub const POSE: usize = 7;

/// Where the sections of `dynamics` begin, in numbers of an environment.
#[derive(Clone, Copy, Debug)]
pub struct Sections {
    pub factors: usize,
    pub weighted: usize,
    pub velocities: usize,
    pub len: usize,
}

impl Sections {
    pub fn of(model: &Model) -> Sections {
        let (dofs, packed) = (model.dofs.len(), model.packed());
        let factors = 6 * dofs;
        let weighted = factors + packed;
        let velocities = weighted + dofs;
        Sections {
            factors,
            weighted,
            velocities,
            len: velocities + 6 * model.bodies.len(),
        }
    }
}

#[allow(clippy::too_many_arguments)]
pub fn launch(
    gpu: &Gpu,
    trees: usize,
    tables: &Buffer<u32>,
    state: &Buffer<f32>,
    targets: &Buffer<f32>,
    pushes: &Buffer<f32>,
    poses: &Buffer<f32>,
    dynamics: &Buffer<f32>,
    params: &Params,
) {
    let [across, ..] = groups(&shader::SMOOTH_DYNAMICS, params.envs as usize);
    gpu.launch(
        &shader::SMOOTH_DYNAMICS,
        [across, trees as u32, 1],
        &[tables, state, targets, pushes, poses, dynamics],
        params,
    );
}

pub fn twin(
    physics: &mut Physics,
    state: &[f32],
    targets: &[f32],
    pushes: &[f32],
    poses: &mut [f32],
    dynamics: &mut [f32],
    params: &Params,
) {
    let (model, envs) = (physics.model.clone(), params.envs as usize);
    let at = Sections::of(&model);
    let mut world = State::new(&model);
    let mut wanted = vec![0.0; model.driven()];
    let mut pushed = vec![0.0; 6 * model.bodies.len()];
    for env in 0..envs {
        read(&model, state, envs, env, &mut world);
        gather(targets, envs, env, 0, &mut wanted);
        gather(pushes, envs, env, 0, &mut pushed);
        let pushed: Vec<Spatial> = pushed.chunks_exact(6).map(spatial).collect();
        physics.articulate(&world.q, &world.v);
        physics.accelerate(&world, &wanted, &pushed);
        for (body, pose) in physics.poses.iter().enumerate() {
            scatter(poses, envs, env, POSE * body, &numbers(pose));
        }
        scatter(dynamics, envs, env, 0, &flat(&physics.axes));
        scatter(dynamics, envs, env, at.factors, &physics.factors);
        scatter(dynamics, envs, env, at.weighted, &physics.weighted);
        scatter(
            dynamics,
            envs,
            env,
            at.velocities,
            &flat(&physics.velocities),
        );
    }
}

/// Positions and velocities of an environment.
pub fn read(model: &Model, state: &[f32], envs: usize, env: usize, world: &mut State) {
    gather(state, envs, env, 0, &mut world.q);
    gather(state, envs, env, model.positions(), &mut world.v);
}

/// The opposite of [`read`].
pub fn write(model: &Model, state: &mut [f32], envs: usize, env: usize, world: &State) {
    scatter(state, envs, env, 0, &world.q);
    scatter(state, envs, env, model.positions(), &world.v);
}

/// A spatial vector of six numbers.
pub fn spatial(numbers: &[f32]) -> Spatial {
    Spatial {
        angular: Vec3::from_slice(numbers),
        linear: Vec3::from_slice(&numbers[3..]),
    }
}

pub fn flat(vectors: &[Spatial]) -> Vec<f32> {
    let numbers = |s: &Spatial| [s.angular.to_array(), s.linear.to_array()];
    vectors.iter().flat_map(numbers).flatten().collect()
}

pub fn numbers(pose: &Pose) -> [f32; POSE] {
    let ([x, y, z], [i, j, k, w]) = (pose.place.to_array(), pose.turn.to_array());
    [x, y, z, i, j, k, w]
}

pub fn pose(numbers: &[f32]) -> Pose {
    Pose {
        place: Vec3::from_slice(numbers),
        turn: Quat::from_slice(&numbers[3..]),
    }
}
