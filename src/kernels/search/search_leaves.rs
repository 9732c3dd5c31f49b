//! The nearest candidate among the leaves that were not pruned. Shader: `shaders/search/search_leaves.wgsl`.

use super::search_exact::squared;
use super::search_index::{LANES, LEAF, offer};
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::features::ROW_STRIDE;

crate::shader_params! {
    pub struct Params for search_leaves {
        /// Queries.
        pub count: u32,
        /// First leaf searched, a multiple of 32.
        pub first: u32,
        /// End of the leaves searched, exclusive.
        pub last: u32,
        /// Bytes stand for numbers from `-range` to `range`.
        pub range: f32,
        /// Distance by which rounding to bytes moves a row at most.
        pub quantisation_error: f32,
    }
}

/// Workgroups along x at most: WebGPU's default limit.
const ACROSS: usize = 65_535;

/// Queues the shader on `gpu`.
pub fn launch(
    gpu: &Gpu,
    rows: &Buffer<f32>,
    quantised_rows: &Buffer<u32>,
    queries: &Buffer<f32>,
    query_projection: &Buffer<f32>,
    leaf_mask: &Buffer<u32>,
    distance: &Buffer<f32>,
    candidates: &Buffer<u32>,
    params: &Params,
) {
    let workgroups = (params.count as usize * LANES).div_ceil(64);
    let across = workgroups.min(ACROSS);
    gpu.launch(
        &shader::SEARCH_LEAVES,
        [across as u32, workgroups.div_ceil(across) as u32, 1],
        &[
            rows,
            quantised_rows,
            queries,
            query_projection,
            leaf_mask,
            distance,
            candidates,
        ],
        params,
    );
}

/// Compares all rows of the leaves in the mask, whatever their bytes.
pub fn twin(
    rows: &[[f32; ROW_STRIDE]],
    _quantised_rows: &[[u8; ROW_STRIDE]],
    queries: &[[f32; ROW_STRIDE]],
    _query_projection: &[f32],
    leaf_mask: &[u32],
    distance: &mut [f32],
    candidates: &mut [u32],
    params: &Params,
) {
    let (count, first) = (params.count as usize, params.first as usize);
    for (at, query) in queries.iter().enumerate().take(count) {
        for leaf in first..params.last as usize {
            let (word, bit) = ((leaf - first) / 32, (leaf - first) % 32);
            if leaf_mask[word * count + at] >> bit & 1 == 0 {
                continue;
            }
            for (i, row) in rows[leaf * LEAF..][..LEAF].iter().enumerate() {
                let mine = i % LANES * count + at;
                let best = (&mut distance[mine], &mut candidates[mine]);
                offer(row, squared(row, query), best.0, best.1);
            }
        }
    }
}
