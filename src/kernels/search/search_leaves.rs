//! The nearest candidate among the leaves within reach. Shader: `shaders/search/search_leaves.wgsl`.

use super::search_index::{LANES, LEAF, offer};
use super::search_exact::squared;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::database::ROW_STRIDE;

crate::shader_params! {
    pub struct Params for search_leaves {
        /// Queries.
        pub count: u32,
        /// The leaves looked at: `first .. last`, `first` a multiple of 32.
        pub first: u32,
        pub last: u32,
        /// Bytes stand for numbers from `-range` to `range`.
        pub range: f32,
        /// How far rounding to bytes moves a row at most.
        pub blur: f32,
    }
}

/// Workgroups along x at most: WebGPU's default limit.
const ACROSS: usize = 65_535;

#[allow(clippy::too_many_arguments)]
pub fn launch(
    gpu: &Gpu,
    rows: &Buffer<f32>,
    coarse: &Buffer<u32>,
    queries: &Buffer<f32>,
    asked: &Buffer<f32>,
    reach: &Buffer<u32>,
    distance: &Buffer<f32>,
    candidates: &Buffer<u32>,
    params: &Params,
) {
    let workgroups = (params.count as usize * LANES).div_ceil(64);
    let across = workgroups.min(ACROSS);
    gpu.launch(
        &shader::SEARCH_LEAVES,
        [across as u32, workgroups.div_ceil(across) as u32, 1],
        &[rows, coarse, queries, asked, reach, distance, candidates],
        params,
    );
}

/// All rows of the leaves within reach, whatever their bytes.
#[allow(clippy::too_many_arguments)]
pub fn twin(
    rows: &[[f32; ROW_STRIDE]],
    _coarse: &[[u8; ROW_STRIDE]],
    queries: &[[f32; ROW_STRIDE]],
    _asked: &[f32],
    reach: &[u32],
    distance: &mut [f32],
    candidates: &mut [u32],
    params: &Params,
) {
    let (count, first) = (params.count as usize, params.first as usize);
    for (at, query) in queries.iter().enumerate().take(count) {
        for leaf in first..params.last as usize {
            let (word, bit) = ((leaf - first) / 32, (leaf - first) % 32);
            if reach[word * count + at] >> bit & 1 == 0 {
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
