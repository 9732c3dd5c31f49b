//! The nearest candidate of one query. Shader: `shaders/search/search_one.wgsl`.

use super::search_exact::squared;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::features::ROW_STRIDE;

crate::shader_params! {
    /// Sizes of the search.
    pub struct Params for search_one {
        /// Rows searched.
        pub candidates: u32,
        /// Workgroups launched.
        pub groups: u32,
    }
}

/// Rows that the workgroups look at together.
const LANES: usize = shader::search_one::constants::LANES as usize;

/// Queues the shader on `gpu`.
pub fn launch(
    gpu: &Gpu,
    rows: &Buffer<f32>,
    query: &Buffer<f32>,
    nearest: &Buffer<u32>,
    params: &Params,
) {
    let groups = [params.groups, 1, 1];
    gpu.launch(&shader::SEARCH_ONE, groups, &[rows, query, nearest], params);
}

/// The shader's computation on the host.
pub fn twin(
    rows: &[[f32; ROW_STRIDE]],
    query: &[f32; ROW_STRIDE],
    nearest: &mut [[u32; 2]],
    params: &Params,
) {
    let groups = params.groups as usize;
    for (group, nearest) in nearest.iter_mut().enumerate().take(groups) {
        let rows = rows.iter().enumerate().take(params.candidates as usize);
        let own = rows.filter(|(row, _)| row / LANES % groups == group);
        let found = own.map(|(row, features)| [squared(features, query).to_bits(), row as u32]);
        *nearest = found.min().unwrap_or([f32::INFINITY.to_bits(), 0]);
    }
}
