//! Scores the blocks of the database for every query, on software adapters.
//! Shader: `shaders/search/search_score_lanes.wgsl`.

use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::features::ROW_STRIDE;

crate::shader_params! {
    pub struct Params for search_score_lanes {
        /// Queries.
        pub count: u32,
        /// Rows scored.
        pub candidates: u32,
        /// Rows a block.
        pub block: u32,
        /// Blocks an invocation scores.
        pub run: u32,
    }
}

/// Queries a workgroup scores.
const QUERIES: u32 =
    shader::search_score_lanes::constants::LANES * shader::search_score_lanes::constants::QUERIES;

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
        &shader::SEARCH_SCORE_LANES,
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
    let count = params.count as usize;
    for (block, rows) in rows.chunks(params.block as usize).enumerate() {
        for (at, query) in queries.iter().enumerate().take(count) {
            let best = rows
                .iter()
                .map(|row| dot(row, query))
                .fold(f32::MIN, f32::max);
            score[block * count + at] = best;
        }
    }
}

fn dot(row: &[f32; ROW_STRIDE], query: &[f32; ROW_STRIDE]) -> f32 {
    row.iter().zip(query).map(|(r, q)| r * q).sum()
}

/// A row with minus half its square as its last number, as the scoring shaders read it.
pub fn with_half_square(row: &[f32; ROW_STRIDE]) -> [f32; ROW_STRIDE] {
    let mut row = *row;
    let square: f64 = row[..ROW_STRIDE - 1]
        .iter()
        .map(|&r| f64::from(r) * f64::from(r))
        .sum();
    row[ROW_STRIDE - 1] = (-0.5 * square) as f32;
    row
}
