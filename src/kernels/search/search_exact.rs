//! The nearest candidate of every query. Shader: `shaders/search/search_exact.wgsl`.

use crate::gpu::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::kernels::fma::mul_add;
use crate::motion::features::{FEATURE_DIM, ROW_STRIDE};

/// Sizes of a whole search.
#[derive(Clone, Copy, Debug)]
pub struct Params {
    /// Queries.
    pub count: u32,
    /// Rows searched.
    pub candidates: u32,
    /// Rows a block of scores.
    pub block: u32,
    /// Norm of the longest row.
    pub max_norm: f32,
}

crate::shader_params! {
    /// One launch of the shader, which compares a run of blocks.
    pub struct BlockRun for search_exact {
        /// Queries.
        pub count: u32,
        /// Rows searched.
        pub candidates: u32,
        /// Rows a block of scores.
        pub block: u32,
        /// First block compared.
        pub first: u32,
        /// End of the blocks compared, exclusive.
        pub last: u32,
        /// Norm of the longest row.
        pub max_norm: f32,
    }
}

/// Rows compared in one launch at most, at four an iteration: with a pass over the scores of all
/// blocks that stays below the 65,535 iterations after which lavapipe silently stops looping.
const ROWS: u32 = 1 << 17;

impl Params {
    /// The launches that together compare every block.
    pub fn block_runs(self) -> impl Iterator<Item = BlockRun> {
        let blocks = self.candidates.div_ceil(self.block);
        let run = (ROWS / self.block).max(1);
        (0..blocks)
            .step_by(run as usize)
            .map(move |first| BlockRun {
                count: self.count,
                candidates: self.candidates,
                block: self.block,
                first,
                last: blocks.min(first + run),
                max_norm: self.max_norm,
            })
    }
}

/// Queues the shader on `gpu`, as often as it takes to compare every block.
pub fn launch(
    gpu: &Gpu,
    rows: &Buffer<f32>,
    queries: &Buffer<f32>,
    score: &Buffer<f32>,
    matched: &Buffer<u32>,
    params: &Params,
) {
    let groups = groups(&shader::SEARCH_EXACT, params.count as usize);
    for run in params.block_runs() {
        gpu.launch(
            &shader::SEARCH_EXACT,
            groups,
            &[rows, queries, score, matched],
            &run,
        );
    }
}

/// Compares all rows, whatever their score: the plain form of every search.
pub fn twin(
    rows: &[[f32; ROW_STRIDE]],
    queries: &[[f32; ROW_STRIDE]],
    _score: &[f32],
    matched: &mut [u32],
    params: &Params,
) {
    for (query, matched) in queries.iter().zip(matched).take(params.count as usize) {
        let (mut best, mut found) = (f32::MAX, 0);
        for (index, row) in rows.iter().enumerate() {
            let distance = squared(row, query);
            if distance < best {
                (best, found) = (distance, index);
            }
        }
        *matched = found as u32;
    }
}

/// Squared distance of two feature rows in four interleaved sums, the order of every form of the
/// search: so they all round alike.
#[inline]
pub fn squared(row: &[f32; ROW_STRIDE], query: &[f32; ROW_STRIDE]) -> f32 {
    let mut sum = [0.0f32; 4];
    for i in 0..FEATURE_DIM {
        let d = row[i] - query[i];
        sum[i % 4] = mul_add(d, d, sum[i % 4]);
    }
    (sum[0] + sum[1]) + (sum[2] + sum[3])
}
