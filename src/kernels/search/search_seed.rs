//! A first candidate for every query, by the index. Shader: `shaders/search/search_seed.wgsl`.

use super::search_exact::squared;
use super::search_index::{
    GROUP, LANES, LEAF, PROJECTION_LEN, block_of, bound, corners, offer, square,
};
use crate::gpu::shader::search_seed::constants;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE, TRAJECTORY_DIM};

crate::shader_params! {
    pub struct Params for search_seed {
        /// Queries.
        pub count: u32,
        /// Groups of leaves.
        pub groups: u32,
        /// Frames of the database.
        pub frames: u32,
        /// Distance a unit of a byte.
        pub step: f32,
        /// Norm of the longest trajectory.
        pub max_norm: f32,
    }
}

/// Queues the shader on `gpu`.
pub fn launch(
    gpu: &Gpu,
    rows: &Buffer<f32>,
    boxes: &Buffer<f32>,
    distance_codes: &Buffer<u32>,
    shown: &Buffer<u32>,
    queries: &Buffer<f32>,
    query_projection: &Buffer<f32>,
    distance: &Buffer<f32>,
    candidates: &Buffer<u32>,
    params: &Params,
) {
    let workgroup = constants::LANES * constants::QUERIES;
    gpu.launch(
        &shader::SEARCH_SEED,
        [params.count.div_ceil(workgroup), 1, 1],
        &[
            rows,
            boxes,
            distance_codes,
            shown,
            queries,
            query_projection,
            distance,
            candidates,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    rows: &[[f32; ROW_STRIDE]],
    boxes: &[[f32; TRAJECTORY_DIM]],
    distance_codes: &[u8],
    shown: &[u32],
    queries: &[[f32; ROW_STRIDE]],
    query_projection: &mut [f32],
    distance: &mut [f32],
    candidates: &mut [u32],
    params: &Params,
) {
    let (count, groups) = (params.count as usize, params.groups as usize);
    for (at, query) in queries.iter().enumerate().take(count) {
        let projected = project(boxes, query);
        let row = block_of(distance_codes, shown[at]) * groups;
        let codes = &distance_codes[4 * params.frames as usize..];
        let (mut least, mut nearest) = (f32::MAX, 0);
        for group in 0..groups {
            let pose = square(codes[row + group], params.step);
            let bound = bound(corners(boxes, group), &projected, pose);
            if bound < least {
                (least, nearest) = (bound, group);
            }
        }
        let (mut best, mut candidate) = (f32::MAX, 0);
        for row in &rows[nearest * GROUP * LEAF..][..GROUP * LEAF] {
            offer(row, squared(row, query), &mut best, &mut candidate);
        }
        for lane in 0..LANES {
            distance[lane * count + at] = best;
            candidates[lane * count + at] = candidate;
        }
        for (axis, value) in projected.into_iter().enumerate() {
            query_projection[axis * count + at] = value;
        }
        let length = query[..FEATURE_DIM]
            .iter()
            .map(|q| q * q)
            .sum::<f32>()
            .sqrt();
        query_projection[(PROJECTION_LEN - 1) * count + at] = 4e-6 * (params.max_norm + length);
    }
}

/// A query's trajectory along the axes.
fn project(boxes: &[[f32; TRAJECTORY_DIM]], query: &[f32; ROW_STRIDE]) -> [f32; TRAJECTORY_DIM] {
    std::array::from_fn(|axis| {
        let each = boxes[axis].iter().zip(&query[POSE_DIM..FEATURE_DIM]);
        each.map(|(axis, value)| axis * value).sum()
    })
}
