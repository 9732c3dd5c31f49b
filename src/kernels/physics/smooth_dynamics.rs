//! Poses, factors of the mass matrix and unconstrained acceleration of articulated bodies. Shader:
//! `shaders/physics/smooth_dynamics.wgsl`.

use super::strided::{gather, scatter};
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::physics::model::Model;
use crate::physics::pose::Pose;
use crate::physics::simulator::{Simulator, SimulatorState};
use crate::physics::spatial::Spatial;
use glam::{Quat, Vec3};

crate::shader_params! {
    pub struct Params for smooth_dynamics {
        /// Environments of the batch.
        pub envs: u32,
        /// Seconds of a step.
        pub dt: f32,
        /// Trees of the model.
        pub trees: u32,
        /// 1: poses and velocities alone.
        pub kinematics_only: u32,
    }
}

/// Numbers of a pose: position, quaternion x y z w.
pub const POSE_DIM: usize = 7;

/// Where the sections of `dynamics` begin, in numbers of an environment.
#[derive(Clone, Copy, Debug)]
pub struct DynamicsLayout {
    /// Packed factor of the mass matrix, `[nm]`; the axes `[dofs * 6]` lie before it.
    pub factors: usize,
    /// Unconstrained acceleration whitened by that factor, `[dofs]`.
    pub qacc_whitened: usize,
    /// Velocities of the bodies about their trees' origins, `[bodies * 6]`.
    pub velocities: usize,
    /// Numbers of an environment in all.
    pub len: usize,
}

impl DynamicsLayout {
    /// Sections for a model.
    pub fn new(model: &Model) -> DynamicsLayout {
        let (dofs, packed) = (model.dofs.len(), model.nm());
        let factors = 6 * dofs;
        let qacc_whitened = factors + packed;
        let velocities = qacc_whitened + dofs;
        DynamicsLayout {
            factors,
            qacc_whitened,
            velocities,
            len: velocities + 6 * model.bodies.len(),
        }
    }
}

/// Queues the shader on `gpu`.
///
/// `tables` is the [`model_table`](fn@super::model_table::model_table), `state` `[nq + nv][envs]`,
/// `targets` `[driven][envs]` (rad), and `external_forces` `[bodies * 6][envs]`: torque (Nm) and
/// force (N) at the centres of mass. Written are `poses`, `[bodies * POSE_DIM][envs]`, in the
/// world, and `dynamics`, `[DynamicsLayout::len][envs]`.
pub fn launch(
    gpu: &Gpu,
    tables: &Buffer<u32>,
    state: &Buffer<f32>,
    targets: &Buffer<f32>,
    external_forces: &Buffer<f32>,
    poses: &Buffer<f32>,
    dynamics: &Buffer<f32>,
    params: &Params,
) {
    let [across, ..] = groups(&shader::SMOOTH_DYNAMICS, params.envs as usize);
    gpu.launch(
        &shader::SMOOTH_DYNAMICS,
        [across, params.trees, 1],
        &[tables, state, targets, external_forces, poses, dynamics],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    simulator: &mut Simulator,
    state: &[f32],
    targets: &[f32],
    external_forces: &[f32],
    poses: &mut [f32],
    dynamics: &mut [f32],
    params: &Params,
) {
    let (model, envs) = (simulator.model.clone(), params.envs as usize);
    let at = DynamicsLayout::new(&model);
    let mut world = SimulatorState::new(&model);
    let mut wanted = vec![0.0; model.nu()];
    let mut pushed = vec![0.0; 6 * model.bodies.len()];
    for env in 0..envs {
        read(&model, state, envs, env, &mut world);
        simulator.kinematics(&world.q, &world.v);
        for (body, pose) in simulator.poses.iter().enumerate() {
            scatter(poses, envs, env, POSE_DIM * body, &numbers(pose));
        }
        let velocities = flat(&simulator.velocities);
        scatter(dynamics, envs, env, at.velocities, &velocities);
        if params.kinematics_only == 1 {
            continue;
        }
        gather(targets, envs, env, 0, &mut wanted);
        gather(external_forces, envs, env, 0, &mut pushed);
        let pushed: Vec<Spatial> = pushed.chunks_exact(6).map(spatial).collect();
        simulator.inertia_and_bias(&world.q, &world.v);
        simulator.smooth_acceleration(&world, &wanted, &pushed);
        scatter(dynamics, envs, env, 0, &flat(&simulator.axes));
        scatter(dynamics, envs, env, at.factors, &simulator.factors);
        scatter(
            dynamics,
            envs,
            env,
            at.qacc_whitened,
            &simulator.qacc_whitened,
        );
    }
}

/// Positions and velocities of an environment.
pub fn read(model: &Model, state: &[f32], envs: usize, env: usize, world: &mut SimulatorState) {
    gather(state, envs, env, 0, &mut world.q);
    gather(state, envs, env, model.nq(), &mut world.v);
}

/// The opposite of [`read`].
pub fn write(model: &Model, state: &mut [f32], envs: usize, env: usize, world: &SimulatorState) {
    scatter(state, envs, env, 0, &world.q);
    scatter(state, envs, env, model.nq(), &world.v);
}

/// A spatial vector of six numbers.
pub fn spatial(numbers: &[f32]) -> Spatial {
    Spatial {
        angular: Vec3::from_slice(numbers),
        linear: Vec3::from_slice(&numbers[3..]),
    }
}

/// Numbers of spatial vectors, angular before linear: the opposite of [`spatial`].
pub fn flat(vectors: &[Spatial]) -> Vec<f32> {
    let numbers = |s: &Spatial| [s.angular.to_array(), s.linear.to_array()];
    vectors.iter().flat_map(numbers).flatten().collect()
}

/// Numbers of a pose: position (m), quaternion x y z w.
pub fn numbers(pose: &Pose) -> [f32; POSE_DIM] {
    let ([x, y, z], [i, j, k, w]) = (pose.position.to_array(), pose.rotation.to_array());
    [x, y, z, i, j, k, w]
}

/// A pose of seven numbers: the opposite of [`numbers`].
pub fn pose(numbers: &[f32]) -> Pose {
    Pose {
        position: Vec3::from_slice(numbers),
        rotation: Quat::from_slice(&numbers[3..]),
    }
}
