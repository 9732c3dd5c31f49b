//! Starts worlds anew, asked to or broken. Shader: `shaders/body/restart.wgsl`.

use super::contact_forces::BROKEN;
use super::strided::{gather, scatter};
use super::solve_and_integrate::NO_KEY;
use crate::physics::model::Model;
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for reset_worlds {
        pub envs: u32,
        /// m/s and rad/s; what is faster is broken.
        pub fastest: f32,
    }
}

#[allow(clippy::too_many_arguments)]
pub fn launch(
    gpu: &Gpu,
    tables: &Buffer<u32>,
    mask: &Buffer<u32>,
    starts: &Buffer<f32>,
    state: &Buffer<f32>,
    warm: &Buffer<u32>,
    watched: &Buffer<u32>,
    forces: &Buffer<f32>,
    tallies: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::RESET_WORLDS,
        groups(&shader::RESET_WORLDS, params.envs as usize),
        &[tables, mask, starts, state, warm, watched, forces, tallies],
        params,
    );
}

#[allow(clippy::too_many_arguments)]
pub fn twin(
    model: &Model,
    slots: usize,
    mask: &[u32],
    starts: &[f32],
    state: &mut [f32],
    warm: &mut [u32],
    watched: &[u32],
    forces: &mut [f32],
    tallies: &mut [u32],
    params: &Params,
) {
    let envs = params.envs as usize;
    let mut values = vec![0.0; model.positions() + model.dofs.len()];
    for env in 0..envs {
        gather(state, envs, env, 0, &mut values);
        let broken = broken(model, &values, params.fastest);
        tallies[BROKEN * envs + env] += u32::from(broken);
        if !broken && mask[env] == 0 {
            continue;
        }
        gather(starts, envs, env, 0, &mut values);
        scatter(state, envs, env, 0, &values);
        scatter(warm, envs, env, 0, &vec![NO_KEY; slots]);
        scatter(
            warm,
            envs,
            env,
            slots,
            &vec![0; 4 * slots + model.joints.len()],
        );
        let entries = model.bodies.len() + watched[0] as usize;
        scatter(forces, envs, env, 0, &vec![0.0; 3 * entries]);
    }
}

/// Whether a state, positions then velocities, has lost all sense.
pub fn broken(model: &Model, values: &[f32], fastest: f32) -> bool {
    let velocities = &values[model.positions()..];
    values.iter().any(|value| !value.is_finite())
        || velocities.iter().any(|speed| speed.abs() > fastest)
}
