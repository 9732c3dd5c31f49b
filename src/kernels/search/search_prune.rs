//! The leaves of the index that may hold something nearer. Shader: `shaders/search/search_prune.wgsl`.

use super::search_index::{GROUP, LANES, PROJECTION_LEN, block_of, bound, corners, limit, square};
use crate::gpu::shader::search_prune::constants;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::features::TRAJECTORY_DIM;

crate::shader_params! {
    pub struct Params for search_prune {
        /// Queries.
        pub count: u32,
        /// Groups of leaves.
        pub groups: u32,
        /// First leaf tested, a multiple of 32.
        pub first: u32,
        /// End of the leaves tested, exclusive.
        pub last: u32,
        /// Leaves an invocation tests, a multiple of 32.
        pub run: u32,
        /// Frames of the database: word of `distance_codes` where those of the groups begin.
        pub frames: u32,
        /// Word of `distance_codes` where those of the leaves begin; 0 if there are none.
        pub leaf_codes: u32,
        /// Distance a unit of a byte.
        pub step: f32,
    }
}

/// Queues the shader on `gpu`.
pub fn launch(
    gpu: &Gpu,
    boxes: &Buffer<f32>,
    distance_codes: &Buffer<u32>,
    shown: &Buffer<u32>,
    query_projection: &Buffer<f32>,
    distance: &Buffer<f32>,
    leaf_mask: &Buffer<u32>,
    params: &Params,
) {
    let workgroup = constants::LANES * constants::QUERIES;
    let runs = (params.last - params.first).div_ceil(params.run);
    gpu.launch(
        &shader::SEARCH_PRUNE,
        [params.count.div_ceil(workgroup), runs, 1],
        &[
            boxes,
            distance_codes,
            shown,
            query_projection,
            distance,
            leaf_mask,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    boxes: &[[f32; TRAJECTORY_DIM]],
    distance_codes: &[u8],
    shown: &[u32],
    query_projection: &[f32],
    distance: &[f32],
    leaf_mask: &mut [u32],
    params: &Params,
) {
    let (count, groups) = (params.count as usize, params.groups as usize);
    let (first, last) = (params.first as usize, params.last as usize);
    for at in 0..count {
        let projected = std::array::from_fn(|axis| query_projection[axis * count + at]);
        let known = (0..LANES).map(|lane| distance[lane * count + at]);
        let slack = query_projection[(PROJECTION_LEN - 1) * count + at];
        let limit = limit(known.fold(f32::MAX, f32::min), slack);
        let row = block_of(distance_codes, shown[at]) * groups;
        for word in 0..(last - first).div_ceil(32) {
            leaf_mask[word * count + at] = 0;
        }
        for leaf in first..last {
            let code = match params.leaf_codes as usize {
                0 => distance_codes[4 * params.frames as usize + row + leaf / GROUP],
                leaves => distance_codes[4 * leaves + row * GROUP + leaf],
            };
            let corners = corners(boxes, groups + leaf);
            let within = bound(corners, &projected, square(code, params.step)) <= limit;
            let (word, bit) = ((leaf - first) / 32, (leaf - first) % 32);
            leaf_mask[word * count + at] |= u32::from(within) << bit;
        }
    }
}
