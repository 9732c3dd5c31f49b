//! Contacts and joint limits as mass-weighted rows of the soft constraint problem. Shader:
//! `shaders/body/constrain.wgsl`.

use super::smooth_dynamics::{Sections, read, spatial};
use super::strided::{gather, scatter};
use crate::physics::collision::Touch;
use crate::physics::model::Model;
use crate::physics::simulator::{Physics, State};
use crate::physics::pgs::{Block, one, three};
use crate::gpu::kernel::groups;
use crate::gpu::shader::make_constraints::constants as at;
use crate::gpu::{Buffer, Gpu, shader};
use glam::Vec3;

crate::shader_params! {
    pub struct Params for make_constraints {
        pub envs: u32,
        /// Seconds of a step.
        pub dt: f32,
    }
}

/// Numbers of a touch: place, normal, tangent, distance.
pub const TOUCH: usize = at::TOUCH as usize;
/// Numbers of a constraint.
pub const CONSTRAINT: usize = at::CONSTRAINT as usize;

/// Rows of workgroups: one a contact, then one for every three joints.
pub fn row_groups(model: &Model, slots: usize) -> usize {
    slots + model.joints.len().div_ceil(3)
}

/// Rows of an environment.
pub fn rows(model: &Model, slots: usize) -> usize {
    3 * slots + model.joints.len()
}

#[allow(clippy::too_many_arguments)]
pub fn launch(
    gpu: &Gpu,
    rows_of_groups: usize,
    tables: &Buffer<u32>,
    state: &Buffer<f32>,
    dynamics: &Buffer<f32>,
    touches: &Buffer<f32>,
    keys: &Buffer<u32>,
    counts: &Buffer<u32>,
    rows: &Buffer<f32>,
    constraints: &Buffer<f32>,
    params: &Params,
) {
    let [across, ..] = groups(&shader::MAKE_CONSTRAINTS, params.envs as usize);
    gpu.launch(
        &shader::MAKE_CONSTRAINTS,
        [across, rows_of_groups as u32, 1],
        &[
            tables,
            state,
            dynamics,
            touches,
            keys,
            counts,
            rows,
            constraints,
        ],
        params,
    );
}

#[allow(clippy::too_many_arguments)]
pub fn twin(
    physics: &mut Physics,
    state: &[f32],
    dynamics: &[f32],
    touches: &[f32],
    keys: &[u32],
    counts: &[u32],
    rows: &mut [f32],
    constraints: &mut [f32],
    params: &Params,
) {
    let (model, envs) = (physics.model.clone(), params.envs as usize);
    let (slots, sections) = (physics.settings.slots, Sections::of(&model));
    let mut world = State::new(&model);
    let mut axes = vec![0.0; sections.factors];
    for (env, &count) in counts[..envs].iter().enumerate() {
        read(&model, state, envs, env, &mut world);
        gather(dynamics, envs, env, 0, &mut axes);
        physics.axes = axes.chunks_exact(6).map(spatial).collect();
        gather(dynamics, envs, env, sections.factors, &mut physics.factors);
        find(physics, touches, keys, envs, env, count as usize);
        physics.constrain(&world);
        for joint in 0..model.joints.len() {
            let place = (slots + joint) * CONSTRAINT;
            scatter(constraints, envs, env, place + at::ACTIVE as usize, &[0.0]);
        }
        for limit in &physics.limits {
            let place = (slots + limit.joint) * CONSTRAINT;
            let mut set = |field: u32, value| {
                scatter(constraints, envs, env, place + field as usize, &[value]);
            };
            set(at::TARGET, limit.target);
            set(at::SOFTNESS, limit.softness);
            set(at::ACTIVE, 1.0);
            set(at::BLOCK, one(&physics.rows, limit.row)[0][0]);
            write_row(physics, limit.row, rows, envs, env, 3 * slots + limit.joint);
        }
        for (slot, contact) in physics.contacts.iter().enumerate() {
            let place = slot * CONSTRAINT;
            scatter(constraints, envs, env, place, &contact.target);
            let values = [contact.softness, contact.friction];
            scatter(
                constraints,
                envs,
                env,
                place + at::SOFTNESS as usize,
                &values,
            );
            let block = three(&physics.rows, contact.row);
            scatter(
                constraints,
                envs,
                env,
                place + at::BLOCK as usize,
                &flat(&block),
            );
            for k in 0..3 {
                write_row(physics, contact.row + k, rows, envs, env, 3 * slot + k);
            }
        }
    }
}

/// The touches of an environment become those a world has found.
fn find(
    physics: &mut Physics,
    touches: &[f32],
    keys: &[u32],
    envs: usize,
    env: usize,
    count: usize,
) {
    physics.found.touches.clear();
    physics.found.keys.clear();
    for slot in 0..count {
        let mut numbers = [0.0; TOUCH];
        gather(touches, envs, env, slot * TOUCH, &mut numbers);
        physics.found.touches.push(Touch {
            place: Vec3::from_slice(&numbers),
            normal: Vec3::from_slice(&numbers[3..]),
            tangent: Vec3::from_slice(&numbers[6..]),
            distance: numbers[9],
        });
        physics.found.keys.push(keys[slot * envs + env]);
    }
}

/// nn nt ns tt ts ss
fn flat(block: &Block) -> [f32; 6] {
    let b = block;
    [b[0][0], b[0][1], b[0][2], b[1][1], b[1][2], b[2][2]]
}

/// A row, to `[rows][quads][envs][4]`.
fn write_row(physics: &Physics, row: usize, rows: &mut [f32], envs: usize, env: usize, to: usize) {
    let quads = physics.model.dofs.len().div_ceil(4);
    let values = &physics.rows.row(row)[..4 * quads];
    for (quad, numbers) in values.chunks_exact(4).enumerate() {
        let place = ((to * quads + quad) * envs + env) * 4;
        rows[place..place + 4].copy_from_slice(numbers);
    }
}
