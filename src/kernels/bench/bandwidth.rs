//! How fast memory can be read and written. Shader: `shaders/bench/bandwidth.wgsl`.

use crate::gpu::{Buffer, Gpu, shader};
use rayon::prelude::*;

crate::shader_params! {
    pub struct Params for bandwidth {
        /// Quadruples of numbers.
        pub count: u32,
        /// Invocations along x.
        pub across: u32,
    }
}

/// Workgroups along x at most: WebGPU's default limit.
const ACROSS: u32 = 65_535;

impl Params {
    /// Parameters that copy so many quadruples, in two dimensions of workgroups where one does not
    /// suffice.
    pub fn new(count: u32) -> Self {
        Params {
            count,
            across: count.div_ceil(64).min(ACROSS) * 64,
        }
    }
}

/// Queues the shader on `gpu`.
///
/// `source` and `copy` are `[count][4]`.
pub fn launch(gpu: &Gpu, source: &Buffer<f32>, copy: &Buffer<f32>, params: &Params) {
    let down = params.count.div_ceil(params.across);
    gpu.launch(
        &shader::BANDWIDTH,
        [params.across / 64, down, 1],
        &[source, copy],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(source: &[[f32; 4]], copy: &mut [[f32; 4]], params: &Params) {
    let count = params.count as usize;
    source[..count]
        .par_chunks(1 << 14)
        .zip(copy[..count].par_chunks_mut(1 << 14))
        .for_each(|(source, copy)| copy.copy_from_slice(source));
}
