//! The square of a gradient's norm, in parts. Shader: `shaders/learn/grad_norm.wgsl`.

use crate::gpu::shader::grad_norm::constants as wgsl;
use crate::gpu::{Buffer, Gpu, shader};
use multiversion::multiversion;

/// Parts that the squares are added up in.
pub const NORM_PARTIALS: usize = wgsl::NORM_PARTIALS as usize;

/// Queues the shader on `gpu`.
///
/// `parameters` holds the gradient's length.
pub fn launch(
    gpu: &Gpu,
    parameters: &Buffer<u32>,
    gradient: &Buffer<f32>,
    norm_partials: &Buffer<f32>,
) {
    let groups = [NORM_PARTIALS as u32, 1, 1];
    gpu.launch(
        &shader::GRAD_NORM,
        groups,
        &[parameters, gradient, norm_partials],
        &(),
    );
}

/// The shader's computation on the host.
#[multiversion(targets("x86_64+avx512f+avx512vl+fma", "x86_64+avx2+fma", "aarch64+neon"))]
pub fn twin(gradient: &[f32], norm_partials: &mut [f32]) {
    norm_partials.fill(0.0);
    let part = gradient.len().div_ceil(NORM_PARTIALS).max(1);
    for (part, sum) in gradient.chunks(part).zip(norm_partials) {
        // Several sums at once, so that they need not wait for each other.
        let mut squares = [0f32; 16];
        for (i, value) in part.iter().enumerate() {
            squares[i % 16] += value * value;
        }
        *sum = squares.iter().sum();
    }
}
