//! Draws targets for the drives at random. Shader: `shaders/body/explore.wgsl`.

use crate::kernels::rng::{gaussian, random4};
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for random_targets {
        pub envs: u32,
        /// Driven degrees of freedom of an environment.
        /// rad
        pub deviation: f32,
        pub seed: u32,
        /// Actions of the run so far: the random numbers' counter.
        pub clock: u32,
        pub stream: u32,
    }
}

pub fn launch(gpu: &Gpu, driven: usize, targets: &Buffer<f32>, params: &Params) {
    let [across, ..] = groups(&shader::RANDOM_TARGETS, params.envs as usize);
    let groups = [across, driven as u32, 1];
    gpu.launch(&shader::RANDOM_TARGETS, groups, &[targets], params);
}

pub fn twin(targets: &mut [f32], params: &Params) {
    let envs = params.envs as usize;
    for (place, target) in targets.iter_mut().enumerate() {
        *target = drawn(params, place / envs, place % envs);
    }
}

/// One target of an environment, rad.
pub fn drawn(params: &Params, index: usize, env: usize) -> f32 {
    let stream = params.stream + index as u32;
    let bits = random4(params.seed, env as u32, params.clock, stream);
    params.deviation * gaussian(bits)
}
