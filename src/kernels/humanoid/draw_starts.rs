//! Draws where ended episodes begin anew. Shader: `shaders/humanoid/draw_starts.wgsl`.

use crate::gpu::shader::draw_starts::constants::STREAM;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::strided::scatter;
use crate::kernels::rng::{index_below, random4};

crate::shader_params! {
    pub struct Params for draw_starts {
        /// Environments of the batch.
        pub envs: u32,
        /// Number of the first environment in the whole batch.
        pub first: u32,
        /// Seed of the random numbers.
        pub seed: u32,
        /// The random numbers' counter, another for every reset.
        pub reset_counter: u32,
        /// States to draw from.
        pub count: u32,
        /// Numbers of a state.
        pub width: u32,
    }
}

/// Queues the shader on `gpu`.
///
/// `mask` is `[envs]`, `start_states` `[count][width]`, `starts` `[width][envs]`.
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
    for env in (0..envs).filter(|&env| mask[env] != 0) {
        scatter(starts, envs, env, 0, start(start_states, env, params));
    }
}

/// The state, `[width]`, from which an environment begins.
pub fn start<'a>(start_states: &'a [f32], env: usize, params: &Params) -> &'a [f32] {
    let width = params.width as usize;
    let key = params.first + env as u32;
    let number = start_of(params.seed, key, params.reset_counter, params.count);
    &start_states[number as usize * width..][..width]
}

/// Which of `count` start states the environment of this number begins in.
pub fn start_of(seed: u32, key: u32, reset_counter: u32, count: u32) -> u32 {
    let [bits, ..] = random4(seed, key, reset_counter, STREAM);
    index_below(bits, count)
}
