//! Gradients with respect to the sums of all layers. Shader: `shaders/learn/backward.wgsl`.

use super::network::BLOCK;
use crate::gpu::{Argument, Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for backward {
        /// Rows of the minibatch.
        pub rows: u32,
    }
}

/// Goes back through so many `networks`, which are all of the layout's.
pub fn launch(
    gpu: &Gpu,
    networks: usize,
    layout: &Buffer<u32>,
    parameters: &Buffer<f32>,
    rows: &Buffer<f32>,
    output_grads: &Buffer<f32>,
    extras: &Buffer<f32>,
    grads: &Buffer<f32>,
    params: &Params,
) {
    let groups = [params.rows.div_ceil(BLOCK as u32), 1, networks as u32];
    let buffers: [&dyn Argument; 6] = [layout, parameters, rows, output_grads, extras, grads];
    gpu.launch(&shader::BACKWARD, groups, &buffers, params);
}
