//! Outputs of dense networks. Shader: `shaders/learn/forward.wgsl`.

use super::network::BLOCK;
use crate::gpu::{Argument, Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for forward {
        /// Rows that are evaluated.
        pub rows: u32,
        /// The first sample.
        pub start: u32,
        /// Numbers of a sample, observations first.
        pub width: u32,
        /// The first network that is evaluated.
        pub network: u32,
        /// Index of the first output.
        pub out_at: u32,
    }
}

/// Evaluates so many `networks`, one after the other into `outputs`. Every block of rows has, in `copies`, the number of
/// the copy of the `parameters`, `[copies][parameters]`, that it is evaluated by; with [`NO_COPY`](super::network::NO_COPY)
/// it is not.
pub fn launch(
    gpu: &Gpu,
    networks: usize,
    layout: &Buffer<u32>,
    samples: &Buffer<f32>,
    parameters: &Buffer<f32>,
    copies: &Buffer<u32>,
    rows: &Buffer<f32>,
    outputs: &Buffer<f32>,
    params: &Params,
) {
    let groups = [params.rows.div_ceil(BLOCK as u32), 1, networks as u32];
    let buffers: [&dyn Argument; 6] = [layout, samples, parameters, copies, rows, outputs];
    gpu.launch(&shader::FORWARD, groups, &buffers, params);
}
