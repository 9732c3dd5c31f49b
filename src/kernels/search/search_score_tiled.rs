//! Scores the blocks of the database for every query, on real GPUs.
//! Shader: `shaders/search/search_score_tiled.wgsl`; its scores are those of
//! `search_score_lanes`.

use super::search_score_lanes;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::features::ROW_STRIDE;

crate::shader_params! {
    pub struct Params for search_score_tiled {
        /// Queries.
        pub count: u32,
        /// Rows scored.
        pub candidates: u32,
        /// Rows a block.
        pub block: u32,
        /// Blocks a workgroup scores.
        pub run: u32,
    }
}

/// Queries a workgroup scores.
const QUERIES: u32 = shader::search_score_tiled::constants::TILE;

/// Queues the shader on `gpu`.
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
        &shader::SEARCH_SCORE_TILED,
        groups,
        &[rows, queries, score],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    rows: &[[f32; ROW_STRIDE]],
    queries: &[[f32; ROW_STRIDE]],
    score: &mut [f32],
    params: &Params,
) {
    let Params {
        count,
        candidates,
        block,
        run,
    } = *params;
    search_score_lanes::twin(
        rows,
        queries,
        score,
        &search_score_lanes::Params {
            count,
            candidates,
            block,
            run,
        },
    );
}
