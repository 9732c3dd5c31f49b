//! Starts worlds anew, asked to or broken. Shader: `shaders/physics/reset_worlds.wgsl`.

use super::contact_forces::DIVERGED;
use super::solve_and_integrate::NO_CONTACT;
use super::strided::{gather, scatter};
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::physics::model::Model;

crate::shader_params! {
    pub struct Params for reset_worlds {
        /// Environments of the batch.
        pub envs: u32,
        /// Contacts an environment has room for.
        pub max_contacts: u32,
        /// m/s and rad/s; what is faster has diverged.
        pub max_speed: f32,
    }
}

/// Queues the shader on `gpu`.
///
/// `tables` is the [`model_table`](fn@super::model_table::model_table); `mask`, `[envs]`, is not 0
/// where to start anew. `starts` and `state` are `[nq + nv][envs]`; `warm_start` is as
/// [`solve_and_integrate`](super::solve_and_integrate) leaves it, `force_pairs`, `forces` and
/// `counters` as [`contact_forces`](super::contact_forces) has them.
pub fn launch(
    gpu: &Gpu,
    tables: &Buffer<u32>,
    mask: &Buffer<u32>,
    starts: &Buffer<f32>,
    state: &Buffer<f32>,
    warm_start: &Buffer<u32>,
    force_pairs: &Buffer<u32>,
    forces: &Buffer<f32>,
    counters: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::RESET_WORLDS,
        groups(&shader::RESET_WORLDS, params.envs as usize),
        &[
            tables,
            mask,
            starts,
            state,
            warm_start,
            force_pairs,
            forces,
            counters,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    model: &Model,
    mask: &[u32],
    starts: &[f32],
    state: &mut [f32],
    warm_start: &mut [u32],
    force_pairs: &[u32],
    forces: &mut [f32],
    counters: &mut [u32],
    params: &Params,
) {
    let (envs, max_contacts) = (params.envs as usize, params.max_contacts as usize);
    let mut values = vec![0.0; model.nq() + model.dofs.len()];
    for env in 0..envs {
        gather(state, envs, env, 0, &mut values);
        let (q, v) = values.split_at(model.nq());
        let diverged = has_diverged(q, v, params.max_speed);
        counters[DIVERGED * envs + env] += u32::from(diverged);
        if !diverged && mask[env] == 0 {
            continue;
        }
        gather(starts, envs, env, 0, &mut values);
        scatter(state, envs, env, 0, &values);
        scatter(warm_start, envs, env, 0, &vec![NO_CONTACT; max_contacts]);
        scatter(
            warm_start,
            envs,
            env,
            max_contacts,
            &vec![0; 4 * max_contacts + model.joints.len()],
        );
        let entries = model.bodies.len() + force_pairs[0] as usize;
        scatter(forces, envs, env, 0, &vec![0.0; 3 * entries]);
    }
}

/// Whether a state is no longer one: a number is not finite, or a speed, m/s or rad/s, over `max_speed`.
pub fn has_diverged(q: &[f32], v: &[f32], max_speed: f32) -> bool {
    q.iter().any(|position| !position.is_finite())
        || v.iter()
            .any(|speed| !speed.is_finite() || speed.abs() > max_speed)
}
