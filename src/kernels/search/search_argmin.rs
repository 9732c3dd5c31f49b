//! The nearest of what was found for a query. Shader: `shaders/search/search_argmin.wgsl`.

use super::search_index::LANES;
use crate::gpu::groups;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for search_argmin {
        /// Queries.
        pub count: u32,
    }
}

/// Queues the shader on `gpu`.
pub fn launch(
    gpu: &Gpu,
    distance: &Buffer<f32>,
    candidates: &Buffer<u32>,
    matched: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::SEARCH_ARGMIN,
        groups(&shader::SEARCH_ARGMIN, params.count as usize),
        &[distance, candidates, matched],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(distance: &[f32], candidates: &[u32], matched: &mut [u32], params: &Params) {
    let count = params.count as usize;
    for (at, matched) in matched.iter_mut().enumerate().take(count) {
        let lanes =
            (0..LANES).map(|lane| (distance[lane * count + at], candidates[lane * count + at]));
        let least = lanes.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        *matched = least.map_or(0, |(_, candidate)| candidate);
    }
}
