//! Contacts and joint limits as mass-weighted rows of the soft constraint problem. Shader:
//! `shaders/physics/make_constraints.wgsl`.

use super::smooth_dynamics::{DynamicsLayout, read, spatial};
use super::strided::{gather, scatter};
use crate::gpu::shader::make_constraints::constants as at;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::physics::collision::ContactPoint;
use crate::physics::model::Model;
use crate::physics::pgs::{ResponseBlock, one, three};
use crate::physics::simulator::{Simulator, SimulatorState};
use glam::Vec3;

crate::shader_params! {
    pub struct Params for make_constraints {
        /// Environments of the batch.
        pub envs: u32,
        /// Seconds of a step.
        pub dt: f32,
        /// See [`row_groups`].
        pub row_groups: u32,
    }
}

/// Numbers of a contact: position, normal, tangent, distance.
pub const CONTACT_DIM: usize = at::CONTACT_DIM as usize;
/// Numbers of a constraint.
pub const CONSTRAINT_DIM: usize = at::CONSTRAINT_DIM as usize;

/// Rows of workgroups: one a contact, then one for every three joints.
pub fn row_groups(model: &Model, max_contacts: usize) -> u32 {
    (max_contacts + model.joints.len().div_ceil(3)) as u32
}

/// Rows of an environment.
pub fn rows(model: &Model, max_contacts: usize) -> usize {
    3 * max_contacts + model.joints.len()
}

/// Queues the shader on `gpu`.
///
/// `tables` is the [`model_table`](fn@super::model_table::model_table), `state` `[nq + nv][envs]`,
/// `dynamics` `[DynamicsLayout::len][envs]`, `contacts` `[max_contacts * CONTACT_DIM][envs]`,
/// `contact_ids` `[max_contacts][envs]`, `counts` `[2][envs]`: contacts kept, and those that found
/// no room. Written are `rows`, `[rows][quads][envs][4]`, each over the degrees of freedom in quads
/// of four, and `constraints`, `[(max_contacts + joints) * CONSTRAINT_DIM][envs]`.
pub fn launch(
    gpu: &Gpu,
    tables: &Buffer<u32>,
    state: &Buffer<f32>,
    dynamics: &Buffer<f32>,
    contacts: &Buffer<f32>,
    contact_ids: &Buffer<u32>,
    counts: &Buffer<u32>,
    rows: &Buffer<f32>,
    constraints: &Buffer<f32>,
    params: &Params,
) {
    let [across, ..] = groups(&shader::MAKE_CONSTRAINTS, params.envs as usize);
    gpu.launch(
        &shader::MAKE_CONSTRAINTS,
        [across, params.row_groups, 1],
        &[
            tables,
            state,
            dynamics,
            contacts,
            contact_ids,
            counts,
            rows,
            constraints,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    simulator: &mut Simulator,
    state: &[f32],
    dynamics: &[f32],
    contacts: &[f32],
    contact_ids: &[u32],
    counts: &[u32],
    rows: &mut [f32],
    constraints: &mut [f32],
    params: &Params,
) {
    let (model, envs) = (simulator.model.clone(), params.envs as usize);
    let (max_contacts, sections) = (simulator.options.max_contacts, DynamicsLayout::new(&model));
    let mut world = SimulatorState::new(&model);
    let mut axes = vec![0.0; sections.factors];
    for (env, &count) in counts[..envs].iter().enumerate() {
        read(&model, state, envs, env, &mut world);
        gather(dynamics, envs, env, 0, &mut axes);
        simulator.axes = axes.chunks_exact(6).map(spatial).collect();
        gather(
            dynamics,
            envs,
            env,
            sections.factors,
            &mut simulator.factors,
        );
        detect_contacts(simulator, contacts, contact_ids, envs, env, count as usize);
        simulator.make_constraints(&world);
        for joint in 0..model.joints.len() {
            let place = (max_contacts + joint) * CONSTRAINT_DIM;
            scatter(constraints, envs, env, place + at::ACTIVE as usize, &[0.0]);
        }
        for limit in &simulator.limit_constraints {
            let place = (max_contacts + limit.joint) * CONSTRAINT_DIM;
            let mut set = |field: u32, value| {
                scatter(constraints, envs, env, place + field as usize, &[value]);
            };
            set(at::TARGET, limit.target);
            set(at::REGULARIZATION, limit.regularization);
            set(at::ACTIVE, 1.0);
            set(at::BLOCK, one(&simulator.rows, limit.row)[0][0]);
            write_row(
                simulator,
                limit.row,
                rows,
                envs,
                env,
                3 * max_contacts + limit.joint,
            );
        }
        for (slot, contact) in simulator.contact_constraints.iter().enumerate() {
            let place = slot * CONSTRAINT_DIM;
            scatter(constraints, envs, env, place, &contact.target);
            let values = [contact.regularization, contact.friction];
            scatter(
                constraints,
                envs,
                env,
                place + at::REGULARIZATION as usize,
                &values,
            );
            let block = three(&simulator.rows, contact.row);
            scatter(
                constraints,
                envs,
                env,
                place + at::BLOCK as usize,
                &flat(&block),
            );
            for k in 0..3 {
                write_row(simulator, contact.row + k, rows, envs, env, 3 * slot + k);
            }
        }
    }
}

/// The touches of an environment become those a world has found.
fn detect_contacts(
    simulator: &mut Simulator,
    contacts: &[f32],
    contact_ids: &[u32],
    envs: usize,
    env: usize,
    count: usize,
) {
    simulator.contacts.points.clear();
    simulator.contacts.ids.clear();
    for slot in 0..count {
        let mut numbers = [0.0; CONTACT_DIM];
        gather(contacts, envs, env, slot * CONTACT_DIM, &mut numbers);
        simulator.contacts.points.push(ContactPoint {
            position: Vec3::from_slice(&numbers),
            normal: Vec3::from_slice(&numbers[3..]),
            tangent: Vec3::from_slice(&numbers[6..]),
            distance: numbers[9],
        });
        simulator.contacts.ids.push(contact_ids[slot * envs + env]);
    }
}

/// nn nt ns tt ts ss
fn flat(block: &ResponseBlock) -> [f32; 6] {
    let b = block;
    [b[0][0], b[0][1], b[0][2], b[1][1], b[1][2], b[2][2]]
}

/// A row, to `[rows][quads][envs][4]`.
fn write_row(
    simulator: &Simulator,
    row: usize,
    rows: &mut [f32],
    envs: usize,
    env: usize,
    to: usize,
) {
    let quads = simulator.model.dofs.len().div_ceil(4);
    let values = &simulator.rows.row(row)[..4 * quads];
    for (quad, numbers) in values.chunks_exact(4).enumerate() {
        let at = ((to * quads + quad) * envs + env) * 4;
        rows[at..at + 4].copy_from_slice(numbers);
    }
}
