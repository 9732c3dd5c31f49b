//! Sums up the episodes that ended. Shader: `shaders/world/tally.wgsl`.

use super::layout::{real, whole};
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for tally {
        pub envs: u32,
    }
}

/// Numbers of a tally: episodes, successes, collisions, truncations, steps, summed return.
pub const SUMS: usize = 6;

pub fn launch(
    gpu: &Gpu,
    real: &Buffer<f32>,
    whole: &Buffer<u32>,
    sums: &Buffer<f32>,
    params: &Params,
) {
    gpu.launch(&shader::TALLY, [1, 1, 1], &[real, whole, sums], params);
}

pub fn twin(real: &mut [f32], whole: &mut [u32], sums: &mut [f32; SUMS], params: &Params) {
    let envs = params.envs as usize;
    let mut count = |field: usize| {
        let part = &mut whole[field * envs..(field + 1) * envs];
        let sum: u32 = part.iter().sum();
        part.fill(0);
        sum as f32
    };
    let returns = &mut real[real::RETURNS * envs..(real::RETURNS + 1) * envs];
    *sums = [
        count(whole::EPISODES),
        count(whole::SUCCESSES),
        count(whole::COLLISIONS),
        count(whole::TRUNCATIONS),
        count(whole::LENGTHS),
        returns.iter().sum(),
    ];
    returns.fill(0.0);
}
