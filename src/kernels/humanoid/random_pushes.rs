//! Pushes at random times. Shader: `shaders/humanoid/random_pushes.wgsl`.

use crate::gpu::shader::random_pushes::constants::STREAM;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::strided::scatter;
use crate::kernels::rng::{index_below, random4, uniform01};
use std::f32::consts::TAU;

crate::shader_params! {
    pub struct Params for random_pushes {
        /// Environments of the batch.
        pub envs: u32,
        /// Number of the first environment in the whole batch.
        pub first: u32,
        /// Seed of the random numbers.
        pub seed: u32,
        /// Steps of the run so far: the random numbers' counter.
        pub step_counter: u32,
        /// Steps of which one has a push.
        pub interval: u32,
        /// The push is in one of the first `jitter` + 1 steps of the interval.
        pub jitter: u32,
        /// The body that is pushed.
        pub body: u32,
        /// Smallest force, N.
        pub min_force: f32,
        /// Largest force, N.
        pub max_force: f32,
    }
}

/// Queues the shader on `gpu`.
///
/// `external_forces` is `[bodies * 6][envs]`, torque and force; but for the horizontal force on the
/// body, it is left as it is.
pub fn launch(gpu: &Gpu, external_forces: &Buffer<f32>, params: &Params) {
    let groups = groups(&shader::RANDOM_PUSHES, params.envs as usize);
    gpu.launch(&shader::RANDOM_PUSHES, groups, &[external_forces], params);
}

/// The shader's computation on the host.
pub fn twin(external_forces: &mut [f32], params: &Params) {
    let envs = params.envs as usize;
    for env in 0..envs {
        let field = 6 * params.body as usize + 3;
        scatter(external_forces, envs, env, field, &push(env, params));
    }
}

/// The horizontal force of this step on the body, N.
pub fn push(env: usize, params: &Params) -> [f32; 2] {
    let window = params.step_counter / params.interval;
    let [when, way, size, _] = random4(params.seed, params.first + env as u32, window, STREAM);
    if params.step_counter % params.interval != index_below(when, params.jitter + 1) {
        return [0.0; 2];
    }
    let (sin, cos) = (TAU * uniform01(way)).sin_cos();
    let force = params.min_force + (params.max_force - params.min_force) * uniform01(size);
    [force * cos, force * sin]
}
