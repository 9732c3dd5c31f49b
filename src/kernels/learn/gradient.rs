//! Gradients of all parameters over each split of a minibatch. Shader: `shaders/learn/gradient.wgsl`.

use super::network::{BLOCK, BatchLayout, LANES, LayerWords};
use crate::gpu::{Argument, Buffer, Gpu, shader};

/// Workgroups of a launch.
pub fn groups(layout: &BatchLayout) -> [u32; 3] {
    let most = |of: fn(&LayerWords) -> u32| layout.layers.iter().map(of).max().unwrap_or(0);
    [
        most(|layer| layer.outputs).div_ceil(LANES),
        most(|layer| layer.inputs).div_ceil(BLOCK as u32) + 1,
        layout.head.splits * layout.head.layers,
    ]
}

/// Queues the shader on `gpu`.
///
/// `groups` as [`groups`] says.
pub fn launch(
    gpu: &Gpu,
    groups: [u32; 3],
    layout: &Buffer<u32>,
    rows: &Buffer<f32>,
    grads: &Buffer<f32>,
    partials: &Buffer<f32>,
) {
    let buffers: [&dyn Argument; 4] = [layout, rows, grads, partials];
    gpu.launch(&shader::GRADIENT, groups, &buffers, &());
}
