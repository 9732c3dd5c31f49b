//! The leaves of the index that may hold something nearer. Shader: `shaders/search/search_reach.wgsl`.

use super::search_index::{ASKED, GROUP, LANES, block_of, bound, corners, limit, square};
use crate::gpu::shader::search_prune::constants;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::features::TRAJECTORY_DIM;

crate::shader_params! {
    pub struct Params for search_prune {
        /// Queries.
        pub count: u32,
        pub groups: u32,
        /// The leaves looked at: `first .. last`, `first` a multiple of 32.
        pub first: u32,
        pub last: u32,
        /// Leaves an invocation looks at, a multiple of 32.
        pub run: u32,
        /// Of the database: word of `codes` where those of the groups begin.
        pub frames: u32,
        /// Word of `codes` where those of the leaves begin; 0 if there are none.
        pub leaf_codes: u32,
        /// Distance a unit of a byte.
        pub step: f32,
    }
}

#[allow(clippy::too_many_arguments)]
pub fn launch(
    gpu: &Gpu,
    boxes: &Buffer<f32>,
    codes: &Buffer<u32>,
    shown: &Buffer<u32>,
    asked: &Buffer<f32>,
    distance: &Buffer<f32>,
    reach: &Buffer<u32>,
    params: &Params,
) {
    let workgroup = constants::LANES * constants::QUERIES;
    let runs = (params.last - params.first).div_ceil(params.run);
    gpu.launch(
        &shader::SEARCH_PRUNE,
        [params.count.div_ceil(workgroup), runs, 1],
        &[boxes, codes, shown, asked, distance, reach],
        params,
    );
}

pub fn twin(
    boxes: &[[f32; TRAJECTORY_DIM]],
    codes: &[u8],
    shown: &[u32],
    asked: &[f32],
    distance: &[f32],
    reach: &mut [u32],
    params: &Params,
) {
    let (count, groups) = (params.count as usize, params.groups as usize);
    let (first, last) = (params.first as usize, params.last as usize);
    for at in 0..count {
        let turned = std::array::from_fn(|axis| asked[axis * count + at]);
        let known = (0..LANES).map(|lane| distance[lane * count + at]);
        let slack = asked[(ASKED - 1) * count + at];
        let limit = limit(known.fold(f32::MAX, f32::min), slack);
        let place = block_of(codes, shown[at]) * groups;
        for word in 0..(last - first).div_ceil(32) {
            reach[word * count + at] = 0;
        }
        for leaf in first..last {
            let code = match params.leaf_codes as usize {
                0 => codes[4 * params.frames as usize + place + leaf / GROUP],
                leaves => codes[4 * leaves + place * GROUP + leaf],
            };
            let corners = corners(boxes, groups + leaf);
            let within = bound(corners, &turned, square(code, params.step)) <= limit;
            let (word, bit) = ((leaf - first) / 32, (leaf - first) % 32);
            reach[word * count + at] |= u32::from(within) << bit;
        }
    }
}
