//! Adds up the splits of a gradient, and adds those of the objective's sums to them. Shader: `shaders/learn/reduce_grads.wgsl`.

use crate::gpu::{Argument, Buffer, Gpu, groups, shader};

/// Queues the shader on `gpu`.
///
/// `layout` is [`BatchLayout::words`](super::network::BatchLayout::words), `partials`
/// `[splits][parameters + sums]`; `gradient`, `[parameters]`, is overwritten, `sums`, `[sums]`,
/// added to.
pub fn launch(
    gpu: &Gpu,
    layout: &Buffer<u32>,
    partials: &Buffer<f32>,
    gradient: &Buffer<f32>,
    sums: &Buffer<f32>,
) {
    let groups = groups(&shader::REDUCE_GRADS, gradient.len() + sums.len());
    let buffers: [&dyn Argument; 4] = [layout, partials, gradient, sums];
    gpu.launch(&shader::REDUCE_GRADS, groups, &buffers, &());
}
