//! Brute-force search for real GPUs. Shader: `shaders/search/search_tile.wgsl`; it answers
//! what `search_wide` answers, so it shares that kernel's twin.

use crate::gpu::{Buffer, Gpu, shader};

pub use super::search_wide::twin;

crate::shader_params! {
    pub struct Params for search_tile {
        /// Queries.
        pub count: u32,
        pub candidates: u32,
        /// Rows a workgroup compares.
        pub chunk: u32,
    }
}

pub fn launch(
    gpu: &Gpu,
    rows: &Buffer<f32>,
    queries: &Buffer<f32>,
    distance: &Buffer<f32>,
    index: &Buffer<u32>,
    params: &Params,
) {
    let groups = [
        params.count.div_ceil(shader::search_tile::constants::TILE),
        params.candidates.div_ceil(params.chunk),
        1,
    ];
    gpu.launch(
        &shader::SEARCH_TILE,
        groups,
        &[rows, queries, distance, index],
        params,
    );
}
