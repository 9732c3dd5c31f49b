//! Scores the blocks of the database for every query, on real GPUs.
//! Shader: `shaders/search/search_tile.wgsl`; it answers what `search_wide` answers.

use super::search_wide;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::database::PADDED;

crate::shader_params! {
    pub struct Params for search_tile {
        /// Queries.
        pub count: u32,
        pub candidates: u32,
        /// Rows a block.
        pub block: u32,
        /// Blocks a workgroup scores.
        pub run: u32,
    }
}

/// Queries a workgroup scores.
const QUERIES: u32 = shader::search_tile::constants::TILE;

pub fn launch(
    gpu: &Gpu,
    rows: &Buffer<f32>,
    queries: &Buffer<f32>,
    score: &Buffer<f32>,
    params: &Params,
) {
    let blocks = params.candidates.div_ceil(params.block);
    let groups = [
        params.count.div_ceil(QUERIES),
        blocks.div_ceil(params.run),
        1,
    ];
    gpu.launch(
        &shader::SEARCH_TILE,
        groups,
        &[rows, queries, score],
        params,
    );
}

pub fn twin(rows: &[[f32; PADDED]], queries: &[[f32; PADDED]], score: &mut [f32], params: &Params) {
    let Params {
        count,
        candidates,
        block,
        run,
    } = *params;
    search_wide::twin(
        rows,
        queries,
        score,
        &search_wide::Params {
            count,
            candidates,
            block,
            run,
        },
    );
}
