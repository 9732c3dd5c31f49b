//! Adds up the splits of a gradient and of the objective's sums. Shader: `shaders/learn/reduce_grads.wgsl`.

use crate::gpu::buffer::Argument;
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for reduce_grads {
        /// 1: the sums begin. 0: they are added to.
        pub begin: u32,
    }
}

pub fn launch(
    gpu: &Gpu,
    layout: &Buffer<u32>,
    partials: &Buffer<f32>,
    gradient: &Buffer<f32>,
    sums: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::REDUCE_GRADS, gradient.len() + sums.len());
    let buffers: [&dyn Argument; 4] = [layout, partials, gradient, sums];
    gpu.launch(&shader::REDUCE_GRADS, groups, &buffers, params);
}
