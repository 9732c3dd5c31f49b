//! Projected Gauss-Seidel over limits and contacts, then a step forward. Shader:
//! `shaders/body/solve.wgsl`.

use super::smooth_dynamics::{Sections, read, write};
use super::strided::{gather, scatter};
use super::make_constraints::CONSTRAINT;
use crate::physics::constraints::{Contact, Limit};
use crate::physics::simulator::{Physics, State};
use crate::gpu::kernel::groups;
use crate::gpu::shader::make_constraints::constants as at;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for solve_and_integrate {
        pub envs: u32,
        /// Seconds of a step.
        pub dt: f32,
    }
}

/// Of no contact.
pub const NO_KEY: u32 = u32::MAX;

/// Numbers that an environment remembers of a step's forces.
pub fn warm(slots: usize, joints: usize) -> usize {
    5 * slots + joints
}

#[allow(clippy::too_many_arguments)]
pub fn launch(
    gpu: &Gpu,
    tables: &Buffer<u32>,
    state: &Buffer<f32>,
    dynamics: &Buffer<f32>,
    rows: &Buffer<f32>,
    constraints: &Buffer<f32>,
    keys: &Buffer<u32>,
    counts: &Buffer<u32>,
    warm: &Buffer<u32>,
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
            keys,
            counts,
            warm,
        ],
        params,
    );
}

#[allow(clippy::too_many_arguments)]
pub fn twin(
    physics: &mut Physics,
    state: &mut [f32],
    dynamics: &[f32],
    rows: &[f32],
    constraints: &[f32],
    keys: &[u32],
    counts: &[u32],
    warm: &mut [u32],
    params: &Params,
) {
    let (model, envs) = (physics.model.clone(), params.envs as usize);
    let (slots, joints) = (physics.settings.slots, model.joints.len());
    let sections = Sections::of(&model);
    let mut world = State::new(&model);
    let mut numbers = [0.0; CONSTRAINT];
    for env in 0..envs {
        read(&model, state, envs, env, &mut world);
        gather(dynamics, envs, env, sections.factors, &mut physics.factors);
        gather(
            dynamics,
            envs,
            env,
            sections.weighted,
            &mut physics.weighted,
        );
        remember(warm, envs, env, slots, &mut world);
        physics.rows.clear();
        physics.limits.clear();
        physics.contacts.clear();
        physics.found.keys.clear();
        for joint in 0..joints {
            gather(
                constraints,
                envs,
                env,
                (slots + joint) * CONSTRAINT,
                &mut numbers,
            );
            if numbers[at::ACTIVE as usize] == 0.0 {
                continue;
            }
            let row = take_row(physics, rows, envs, env, 3 * slots + joint);
            physics.limits.push(Limit {
                joint,
                row,
                target: numbers[at::TARGET as usize],
                softness: numbers[at::SOFTNESS as usize],
                force: world.limits[joint],
            });
        }
        for slot in 0..counts[env] as usize {
            gather(constraints, envs, env, slot * CONSTRAINT, &mut numbers);
            let key = keys[slot * envs + env];
            let row = take_row(physics, rows, envs, env, 3 * slot);
            take_row(physics, rows, envs, env, 3 * slot + 1);
            take_row(physics, rows, envs, env, 3 * slot + 2);
            physics.found.keys.push(key);
            physics.contacts.push(Contact {
                row,
                friction: numbers[at::FRICTION as usize],
                target: [numbers[0], numbers[1], numbers[2]],
                softness: numbers[at::SOFTNESS as usize],
                forces: world.remembered(key),
            });
        }
        physics.relax();
        physics.advance(&mut world);
        write(&model, state, envs, env, &world);
        record(&world, warm, envs, env, slots);
    }
}

/// Forces of the step before.
fn remember(warm: &[u32], envs: usize, env: usize, slots: usize, world: &mut State) {
    world.keys.clear();
    world.forces.clear();
    for slot in 0..slots {
        let key = warm[slot * envs + env];
        if key != NO_KEY {
            let mut forces = [0; 4];
            gather(warm, envs, env, slots + 4 * slot, &mut forces);
            world.keys.push(key);
            world.forces.push(forces.map(f32::from_bits));
        }
    }
    let mut limits = vec![0; world.limits.len()];
    gather(warm, envs, env, 5 * slots, &mut limits);
    world.limits = limits.into_iter().map(f32::from_bits).collect();
}

/// Forces of this step.
fn record(world: &State, warm: &mut [u32], envs: usize, env: usize, slots: usize) {
    for slot in 0..slots {
        let key = world.keys.get(slot).copied().unwrap_or(NO_KEY);
        let forces = world.forces.get(slot).copied().unwrap_or_default();
        scatter(warm, envs, env, slot, &[key]);
        scatter(warm, envs, env, slots + 4 * slot, &forces.map(f32::to_bits));
    }
    let limits: Vec<u32> = world.limits.iter().map(|force| force.to_bits()).collect();
    scatter(warm, envs, env, 5 * slots, &limits);
}

/// Reads a row, and gives its place among the world's.
fn take_row(physics: &mut Physics, rows: &[f32], envs: usize, env: usize, from: usize) -> usize {
    let quads = physics.model.dofs.len().div_ceil(4);
    let row = physics.rows.add();
    let values = &mut physics.rows.row_mut(row)[..4 * quads];
    for (quad, numbers) in values.chunks_exact_mut(4).enumerate() {
        let place = ((from * quads + quad) * envs + env) * 4;
        numbers.copy_from_slice(&rows[place..place + 4]);
    }
    row
}
