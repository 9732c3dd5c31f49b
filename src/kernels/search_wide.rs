//! Brute-force search for software adapters. Shader: `shaders/search/search_wide.wgsl`.

use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::database::PADDED;

crate::shader_params! {
    pub struct Params for search_wide {
        /// Queries.
        pub count: u32,
        pub candidates: u32,
        /// Rows a workgroup compares.
        pub chunk: u32,
    }
}

/// Queries a workgroup answers.
const QUERIES: u32 =
    shader::search_wide::constants::LANES * shader::search_wide::constants::QUERIES;

pub fn launch(
    gpu: &Gpu,
    rows: &Buffer<f32>,
    queries: &Buffer<f32>,
    distance: &Buffer<f32>,
    index: &Buffer<u32>,
    params: &Params,
) {
    let groups = [
        params.count.div_ceil(QUERIES),
        params.candidates.div_ceil(params.chunk),
        1,
    ];
    gpu.launch(
        &shader::SEARCH_WIDE,
        groups,
        &[rows, queries, distance, index],
        params,
    );
}

/// The plain form of every search: the squared distance of the nearest row of each chunk, and
/// the lowest index that has it.
pub fn twin(
    rows: &[[f32; PADDED]],
    queries: &[[f32; PADDED]],
    distance: &mut [f32],
    index: &mut [u32],
    params: &Params,
) {
    let count = params.count as usize;
    for (chunk, part) in rows.chunks(params.chunk as usize).enumerate() {
        for (at, query) in queries.iter().enumerate().take(count) {
            let (mut best, mut found) = (f32::MAX, 0);
            for (i, row) in part.iter().enumerate() {
                let d = squared(row, query);
                if d < best {
                    (best, found) = (d, i);
                }
            }
            distance[chunk * count + at] = best;
            index[chunk * count + at] = chunk as u32 * params.chunk + found as u32;
        }
    }
}

/// Squared Euclidean distance, summed in the order of the dimensions.
#[inline]
pub fn squared(row: &[f32; PADDED], query: &[f32; PADDED]) -> f32 {
    row.iter().zip(query).fold(0.0, |sum, (r, q)| {
        let d = r - q;
        d.mul_add(d, sum)
    })
}
