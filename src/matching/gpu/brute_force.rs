//! The search on the GPU over all rows, by the kernels that suit the adapter.

use crate::gpu::{Buffer, Gpu};
use crate::kernels::search::{search_exact, search_score_lanes, search_score_tiled};
use crate::motion::features::ROW_STRIDE;

/// The rows on the device, and what the search needs for batches of one size.
pub struct BruteForceSearch {
    /// `[candidates][ROW_STRIDE]`, with half squares: see [`search_score_lanes::with_half_square`].
    rows: Buffer<f32>,
    candidates: u32,
    count: u32,
    block: u32,
    max_norm: f32,
    /// `[blocks][count]`
    score: Buffer<f32>,
    matched: Buffer<u32>,
}

/// Rows a block at least: one tile of `search_score_tiled`.
const BLOCK: u32 = 64;
/// Blocks at most: `search_exact` passes over all of them twice, and lavapipe silently stops after
/// 65,535 loop iterations.
const BLOCKS: u32 = 16_384;
/// Scores at most: WebGPU's default limit of 128 MiB a binding.
const SCORES: u32 = 1 << 25;
/// Blocks an invocation scores at most: enough work for each, enough invocations for all.
const RUN: u32 = 32;
/// Rows an invocation scores at most, for lavapipe's limit again.
const ROWS: u32 = 32_768;

impl BruteForceSearch {
    /// For batches of `count` queries.
    pub fn new(gpu: &Gpu, rows: &[[f32; ROW_STRIDE]], count: usize) -> Self {
        let candidates = rows.len() as u32;
        let blocks = BLOCKS.min(SCORES / count as u32).max(1);
        let block = BLOCK * candidates.div_ceil(BLOCK * blocks);
        let halved: Vec<_> = rows
            .iter()
            .map(search_score_lanes::with_half_square)
            .collect();
        let square = halved
            .iter()
            .map(|row| -2.0 * row[ROW_STRIDE - 1])
            .fold(0.0, f32::max);
        BruteForceSearch {
            rows: Buffer::from_slice(gpu, halved.as_flattened()),
            candidates,
            count: count as u32,
            block,
            max_norm: square.sqrt(),
            score: Buffer::zeroed(gpu, candidates.div_ceil(block) as usize * count),
            matched: Buffer::zeroed(gpu, count),
        }
    }

    /// Nearest row of every query `[count][ROW_STRIDE]`, whose last number must be 1.
    pub fn nearest(&self, gpu: &Gpu, queries: &Buffer<f32>) -> &Buffer<u32> {
        let BruteForceSearch {
            candidates,
            count,
            block,
            max_norm,
            ..
        } = *self;
        let run = (ROWS / block).clamp(1, RUN);
        if gpu.software {
            let params = search_score_lanes::Params {
                count,
                candidates,
                block,
                run,
            };
            search_score_lanes::launch(gpu, &self.rows, queries, &self.score, &params);
        } else {
            let params = search_score_tiled::Params {
                count,
                candidates,
                block,
                run,
            };
            search_score_tiled::launch(gpu, &self.rows, queries, &self.score, &params);
        }
        let params = search_exact::Params {
            count,
            candidates,
            block,
            max_norm,
        };
        search_exact::launch(
            gpu,
            &self.rows,
            queries,
            &self.score,
            &self.matched,
            &params,
        );
        &self.matched
    }
}
