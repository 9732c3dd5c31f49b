//! Sums over the episodes of all environments. Shader: `shaders/humanoid/episode_sums.wgsl`.

use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for episode_sums {
        /// Environments of the batch.
        pub envs: u32,
        /// First of the fields to be summed.
        pub start: u32,
        /// How many they are.
        pub fields: u32,
    }
}

/// Sums `params.fields` fields of `values`, `[..][envs]`, from `params.start` on into `sums`, one number
/// a field, and sets them to zero.
pub fn launch(gpu: &Gpu, values: &Buffer<f32>, sums: &Buffer<f32>, params: &Params) {
    let groups = [params.fields, 1, 1];
    gpu.launch(&shader::EPISODE_SUMS, groups, &[values, sums], params);
}

/// The shader's computation on the host.
pub fn twin(values: &mut [f32], sums: &mut [f32], params: &Params) {
    let envs = params.envs as usize;
    let fields = values[params.start as usize * envs..].chunks_exact_mut(envs);
    for (field, sum) in fields.zip(sums).take(params.fields as usize) {
        *sum = field.iter().sum();
        field.fill(0.0);
    }
}
