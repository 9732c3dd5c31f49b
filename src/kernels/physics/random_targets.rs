//! Draws targets for the drives at random. Shader: `shaders/physics/random_targets.wgsl`.

use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::rng::{gaussian, random4};

crate::shader_params! {
    pub struct Params for random_targets {
        /// Environments of the batch.
        pub envs: u32,
        /// Drives of an environment.
        pub driven: u32,
        /// Standard deviation of the targets, rad.
        pub action_std: f32,
        /// Seed of the random numbers.
        pub seed: u32,
        /// Actions of the run so far: the random numbers' counter.
        pub step_counter: u32,
        /// Stream of random numbers of the first drive; the other drives have those that follow.
        pub stream: u32,
    }
}

/// Queues the shader on `gpu`.
///
/// `targets` is `[driven][envs]`, rad.
pub fn launch(gpu: &Gpu, targets: &Buffer<f32>, params: &Params) {
    let [across, ..] = groups(&shader::RANDOM_TARGETS, params.envs as usize);
    let groups = [across, params.driven, 1];
    gpu.launch(&shader::RANDOM_TARGETS, groups, &[targets], params);
}

/// The shader's computation on the host.
pub fn twin(targets: &mut [f32], params: &Params) {
    let envs = params.envs as usize;
    let targets = targets.iter_mut().take(envs * params.driven as usize);
    for (index, wanted) in targets.enumerate() {
        *wanted = target(params, index / envs, index % envs);
    }
}

/// One target of an environment, rad.
pub fn target(params: &Params, index: usize, env: usize) -> f32 {
    let stream = params.stream + index as u32;
    let bits = random4(params.seed, env as u32, params.step_counter, stream);
    params.action_std * gaussian(bits)
}
