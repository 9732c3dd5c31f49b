//! Draws where ended episodes begin anew. Shader: `shaders/humanoid/draw_starts.wgsl`.

use crate::gpu::shader::draw_starts::constants::STREAM;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::strided::scatter;
use crate::kernels::rng::{index_below, random4};

crate::shader_params! {
    pub struct Params for draw_starts {
        /// Environments of the batch.
        pub envs: u32,
        /// Agents of an environment, each of which draws for itself.
        pub agents: u32,
        /// Number of the first environment in the whole batch.
        pub first: u32,
        /// Seed of the random numbers.
        pub seed: u32,
        /// The random numbers' counter, another for every reset.
        pub reset_counter: u32,
        /// States to draw from.
        pub count: u32,
        /// Positions of a state.
        pub positions: u32,
        /// Velocities of a state.
        pub velocities: u32,
    }
}

/// Queues the shader on `gpu`.
///
/// `mask` is `[envs]`, `start_states` `[count][positions + velocities]`, `starts`
/// `[agents * (positions + velocities)][envs]`: the positions of all agents, then their velocities.
pub fn launch(
    gpu: &Gpu,
    mask: &Buffer<u32>,
    start_states: &Buffer<f32>,
    starts: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::DRAW_STARTS, params.envs as usize);
    let buffers: [&dyn crate::gpu::Argument; 3] = [mask, start_states, starts];
    gpu.launch(&shader::DRAW_STARTS, groups, &buffers, params);
}

/// The shader's computation on the host.
pub fn twin(mask: &[u32], start_states: &[f32], starts: &mut [f32], params: &Params) {
    let envs = params.envs as usize;
    let mut start = vec![0.0; starts.len() / envs];
    for env in (0..envs).filter(|&env| mask[env] != 0) {
        draw(start_states, env, &mut start, params);
        scatter(starts, envs, env, 0, &start);
    }
}

/// Draws the state from which an environment begins, `[agents * (positions + velocities)]`.
pub fn draw(start_states: &[f32], env: usize, start: &mut [f32], params: &Params) {
    let (positions, velocities) = (params.positions as usize, params.velocities as usize);
    let agents = params.agents as usize;
    let (q, v) = start.split_at_mut(agents * positions);
    let own = q
        .chunks_exact_mut(positions)
        .zip(v.chunks_exact_mut(velocities));
    for (agent, (q, v)) in own.enumerate() {
        let key = (params.first + env as u32) * params.agents + agent as u32;
        let number = start_of(params.seed, key, params.reset_counter, params.count) as usize;
        let state = &start_states[number * (positions + velocities)..];
        q.copy_from_slice(&state[..positions]);
        v.copy_from_slice(&state[positions..][..velocities]);
    }
}

/// Which of `count` start states the agent of this number begins in.
pub fn start_of(seed: u32, key: u32, reset_counter: u32, count: u32) -> u32 {
    let [bits, ..] = random4(seed, key, reset_counter, STREAM);
    index_below(bits, count)
}
