//! Adds up the pieces of a gradient and of the losses. Shader: `shaders/learn/total.wgsl`.

use super::network::{GROUP, Plan, SUMS};
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for reduce_grads {
        pub parameters: u32,
        /// 1: the first minibatch of a pass.
        pub begin: u32,
    }
}

pub fn launch(
    gpu: &Gpu,
    plan: &Buffer<u32>,
    partials: &Buffer<f32>,
    gradient: &Buffer<f32>,
    squares: &Buffer<f32>,
    losses: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::REDUCE_GRADS, params.parameters as usize + SUMS);
    let buffers: [&dyn crate::gpu::buffer::Argument; 5] =
        [plan, partials, gradient, squares, losses];
    gpu.launch(&shader::REDUCE_GRADS, groups, &buffers, params);
}

pub fn twin(
    plan: &Plan,
    partials: &[f32],
    gradient: &mut [f32],
    squares: &mut [f32],
    losses: &mut [f32],
    params: &Params,
) {
    let parameters = params.parameters as usize;
    let pieces = partials.chunks_exact(parameters + SUMS);
    let pieces: Vec<&[f32]> = pieces.take(plan.head.pieces as usize).collect();
    let sum = |at: usize| pieces.iter().map(|piece| piece[at]).sum::<f32>();
    for (at, gradient) in gradient.iter_mut().enumerate().take(parameters) {
        *gradient = sum(at);
    }
    for (at, loss) in losses.iter_mut().enumerate() {
        let before = if params.begin == 1 { 0.0 } else { *loss };
        *loss = sum(parameters + at) + before;
    }
    for (group, square) in squares.iter_mut().enumerate() {
        let own = gradient[..parameters]
            .iter()
            .skip(group * GROUP)
            .take(GROUP);
        *square = own.map(|g| g * g).sum();
    }
}
