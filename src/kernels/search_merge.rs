//! Joins the chunks' winners. Shader: `shaders/search/search_merge.wgsl`.

use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for search_merge {
        /// Queries.
        pub count: u32,
        pub chunks: u32,
    }
}

pub fn launch(
    gpu: &Gpu,
    distance: &Buffer<f32>,
    index: &Buffer<u32>,
    matched: &Buffer<u32>,
    params: &Params,
) {
    let groups = groups(&shader::SEARCH_MERGE, params.count as usize);
    gpu.launch(
        &shader::SEARCH_MERGE,
        groups,
        &[distance, index, matched],
        params,
    );
}

pub fn twin(distance: &[f32], index: &[u32], matched: &mut [u32], params: &Params) {
    let count = params.count as usize;
    for (at, out) in matched.iter_mut().enumerate().take(count) {
        let mut best = at;
        for chunk in 1..params.chunks as usize {
            let other = chunk * count + at;
            if distance[other] < distance[best] {
                best = other;
            }
        }
        *out = index[best];
    }
}
