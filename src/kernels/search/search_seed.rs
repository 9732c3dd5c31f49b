//! A first candidate for every query, by the index. Shader: `shaders/search/search_near.wgsl`.

use super::search_index::{ASKED, GROUP, LANES, LEAF, block_of, bound, corners, offer, square};
use super::search_exact::squared;
use crate::gpu::shader::search_seed::constants;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::database::ROW_STRIDE;
use crate::motion::features::{FEATURE_DIM, POSE_DIM, TRAJECTORY_DIM};

crate::shader_params! {
    pub struct Params for search_seed {
        /// Queries.
        pub count: u32,
        pub groups: u32,
        /// Of the database.
        pub frames: u32,
        /// Distance a unit of a byte.
        pub step: f32,
        /// Length of the longest trajectory.
        pub longest: f32,
    }
}

#[allow(clippy::too_many_arguments)]
pub fn launch(
    gpu: &Gpu,
    rows: &Buffer<f32>,
    boxes: &Buffer<f32>,
    codes: &Buffer<u32>,
    shown: &Buffer<u32>,
    queries: &Buffer<f32>,
    asked: &Buffer<f32>,
    distance: &Buffer<f32>,
    candidates: &Buffer<u32>,
    params: &Params,
) {
    let workgroup = constants::LANES * constants::QUERIES;
    gpu.launch(
        &shader::SEARCH_SEED,
        [params.count.div_ceil(workgroup), 1, 1],
        &[
            rows, boxes, codes, shown, queries, asked, distance, candidates,
        ],
        params,
    );
}

#[allow(clippy::too_many_arguments)]
pub fn twin(
    rows: &[[f32; ROW_STRIDE]],
    boxes: &[[f32; TRAJECTORY_DIM]],
    codes: &[u8],
    shown: &[u32],
    queries: &[[f32; ROW_STRIDE]],
    asked: &mut [f32],
    distance: &mut [f32],
    candidates: &mut [u32],
    params: &Params,
) {
    let (count, groups) = (params.count as usize, params.groups as usize);
    for (at, query) in queries.iter().enumerate().take(count) {
        let turned = turn(boxes, query);
        let place = block_of(codes, shown[at]) * groups;
        let codes = &codes[4 * params.frames as usize..];
        let (mut least, mut nearest) = (f32::MAX, 0);
        for group in 0..groups {
            let pose = square(codes[place + group], params.step);
            let bound = bound(corners(boxes, group), &turned, pose);
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
        for (axis, value) in turned.into_iter().enumerate() {
            asked[axis * count + at] = value;
        }
        let length = query[..FEATURE_DIM].iter().map(|q| q * q).sum::<f32>().sqrt();
        asked[(ASKED - 1) * count + at] = 4e-6 * (params.longest + length);
    }
}

/// A query's trajectory along the axes.
fn turn(boxes: &[[f32; TRAJECTORY_DIM]], query: &[f32; ROW_STRIDE]) -> [f32; TRAJECTORY_DIM] {
    std::array::from_fn(|axis| {
        let each = boxes[axis].iter().zip(&query[POSE_DIM..FEATURE_DIM]);
        each.map(|(axis, value)| axis * value).sum()
    })
}
