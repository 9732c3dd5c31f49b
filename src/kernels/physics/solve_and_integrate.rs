//! Projected Gauss-Seidel over limits and contacts, then a step forward. Shader:
//! `shaders/physics/solve_and_integrate.wgsl`.

use super::make_constraints::CONSTRAINT_DIM;
use super::smooth_dynamics::{DynamicsLayout, read, write};
use super::strided::{gather, scatter};
use crate::gpu::shader::make_constraints::constants as at;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::physics::constraints::{ContactConstraint, LimitConstraint};
use crate::physics::model::Model;
use crate::physics::simulator::{Simulator, SimulatorState};

crate::shader_params! {
    pub struct Params for solve_and_integrate {
        /// Environments of the batch.
        pub envs: u32,
        /// Seconds of a step.
        pub dt: f32,
    }
}

/// Id of no contact.
pub const NO_CONTACT: u32 = u32::MAX;

/// Numbers of `warm_start` of an environment: ids of contacts, the forces of their edges, those of limits.
pub fn warm_start_dim(max_contacts: usize, joints: usize) -> usize {
    5 * max_contacts + joints
}

/// Contacts that there is room for in a `warm_start` of so many numbers: the opposite of
/// [`warm_start_dim`].
pub fn warm_start_room(dim: usize, joints: usize) -> usize {
    dim.saturating_sub(joints) / 5
}

/// The `warm_start` of a batch with another room for contacts; those beyond the new one start without a guess.
pub fn with_room(model: &Model, warm_start: &[u32], envs: usize, room: [usize; 2]) -> Vec<u32> {
    let mut world = SimulatorState::new(model);
    let mut with_room = vec![0; warm_start_dim(room[1], model.joints.len()) * envs];
    for env in 0..envs {
        read_warm_start(warm_start, envs, env, room[0], &mut world);
        write_warm_start(&world, &mut with_room, envs, env, room[1]);
    }
    with_room
}

/// Queues the shader on `gpu`.
///
/// `tables` is the [`model_table`](fn@super::model_table::model_table), `state` `[nq + nv][envs]`,
/// which is advanced, `dynamics` `[DynamicsLayout::len][envs]`; `rows`, `constraints`,
/// `contact_ids` and `counts` are those of [`make_constraints`](super::make_constraints).
/// `warm_start`, `[warm_start_dim][envs]`, holds the forces of the step before, as bits, and then
/// those of this one; see [`warm_start_dim`].
pub fn launch(
    gpu: &Gpu,
    tables: &Buffer<u32>,
    state: &Buffer<f32>,
    dynamics: &Buffer<f32>,
    rows: &Buffer<f32>,
    constraints: &Buffer<f32>,
    contact_ids: &Buffer<u32>,
    counts: &Buffer<u32>,
    warm_start: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::SOLVE_AND_INTEGRATE,
        groups(&shader::SOLVE_AND_INTEGRATE, params.envs as usize),
        &[
            tables,
            state,
            dynamics,
            rows,
            constraints,
            contact_ids,
            counts,
            warm_start,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    simulator: &mut Simulator,
    state: &mut [f32],
    dynamics: &[f32],
    rows: &[f32],
    constraints: &[f32],
    contact_ids: &[u32],
    counts: &[u32],
    warm_start: &mut [u32],
    params: &Params,
) {
    let (model, envs) = (simulator.model.clone(), params.envs as usize);
    let (max_contacts, joints) = (simulator.options.max_contacts, model.joints.len());
    let sections = DynamicsLayout::new(&model);
    let mut world = SimulatorState::new(&model);
    let mut numbers = [0.0; CONSTRAINT_DIM];
    for env in 0..envs {
        read(&model, state, envs, env, &mut world);
        gather(
            dynamics,
            envs,
            env,
            sections.factors,
            &mut simulator.factors,
        );
        gather(
            dynamics,
            envs,
            env,
            sections.qacc_whitened,
            &mut simulator.qacc_whitened,
        );
        read_warm_start(warm_start, envs, env, max_contacts, &mut world);
        simulator.rows.clear();
        simulator.limit_constraints.clear();
        simulator.contact_constraints.clear();
        simulator.contacts.ids.clear();
        for joint in 0..joints {
            gather(
                constraints,
                envs,
                env,
                (max_contacts + joint) * CONSTRAINT_DIM,
                &mut numbers,
            );
            if numbers[at::ACTIVE as usize] == 0.0 {
                continue;
            }
            let row = take_row(simulator, rows, envs, env, 3 * max_contacts + joint);
            simulator.limit_constraints.push(LimitConstraint {
                joint,
                row,
                target: numbers[at::TARGET as usize],
                regularization: numbers[at::REGULARIZATION as usize],
                force: world.limit_forces[joint],
            });
        }
        for slot in 0..counts[env] as usize {
            gather(constraints, envs, env, slot * CONSTRAINT_DIM, &mut numbers);
            let id = contact_ids[slot * envs + env];
            let row = take_row(simulator, rows, envs, env, 3 * slot);
            take_row(simulator, rows, envs, env, 3 * slot + 1);
            take_row(simulator, rows, envs, env, 3 * slot + 2);
            simulator.contacts.ids.push(id);
            simulator.contact_constraints.push(ContactConstraint {
                row,
                friction: numbers[at::FRICTION as usize],
                target: [numbers[0], numbers[1], numbers[2]],
                regularization: numbers[at::REGULARIZATION as usize],
                forces: world.warm_start_forces(id),
            });
        }
        simulator.solve();
        simulator.advance(&mut world);
        write(&model, state, envs, env, &world);
        write_warm_start(&world, warm_start, envs, env, max_contacts);
    }
}

/// Reads the forces of the step before out of `warm_start`.
pub fn read_warm_start(
    warm_start: &[u32],
    envs: usize,
    env: usize,
    max_contacts: usize,
    world: &mut SimulatorState,
) {
    world.contact_ids.clear();
    world.contact_forces.clear();
    for slot in 0..max_contacts {
        let id = warm_start[slot * envs + env];
        if id != NO_CONTACT {
            let mut forces = [0; 4];
            gather(warm_start, envs, env, max_contacts + 4 * slot, &mut forces);
            world.contact_ids.push(id);
            world.contact_forces.push(forces.map(f32::from_bits));
        }
    }
    let mut limits = vec![0; world.limit_forces.len()];
    gather(warm_start, envs, env, 5 * max_contacts, &mut limits);
    world.limit_forces = limits.into_iter().map(f32::from_bits).collect();
}

/// Writes the forces of a step to `warm_start`.
pub fn write_warm_start(
    world: &SimulatorState,
    warm_start: &mut [u32],
    envs: usize,
    env: usize,
    max_contacts: usize,
) {
    for slot in 0..max_contacts {
        let id = world.contact_ids.get(slot).copied().unwrap_or(NO_CONTACT);
        let forces = world.contact_forces.get(slot).copied().unwrap_or_default();
        scatter(warm_start, envs, env, slot, &[id]);
        scatter(
            warm_start,
            envs,
            env,
            max_contacts + 4 * slot,
            &forces.map(f32::to_bits),
        );
    }
    let limits: Vec<u32> = world
        .limit_forces
        .iter()
        .map(|force| force.to_bits())
        .collect();
    scatter(warm_start, envs, env, 5 * max_contacts, &limits);
}

/// Reads a row, and gives its place among the world's.
fn take_row(
    simulator: &mut Simulator,
    rows: &[f32],
    envs: usize,
    env: usize,
    from: usize,
) -> usize {
    let quads = simulator.model.dofs.len().div_ceil(4);
    let row = simulator.rows.add();
    let values = &mut simulator.rows.row_mut(row)[..4 * quads];
    for (quad, numbers) in values.chunks_exact_mut(4).enumerate() {
        let at = ((from * quads + quad) * envs + env) * 4;
        numbers.copy_from_slice(&rows[at..at + 4]);
    }
    row
}
