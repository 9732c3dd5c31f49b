//! The search on the GPU by the index.

use crate::gpu::{Buffer, Gpu};
use crate::kernels::search::search_index::{ASKED, GROUP, LANES};
use crate::kernels::search::{search_leaves, search_seed, search_argmin, search_prune};
use crate::matching::{Index, Packed};

/// The index on the device, and what the search needs for batches of one size.
pub struct Indexed {
    rows: Buffer<f32>,
    coarse: Buffer<u32>,
    boxes: Buffer<f32>,
    codes: Buffer<u32>,
    /// `[ASKED][count]`
    asked: Buffer<f32>,
    /// `[SLICE / 32][count]`
    reach: Buffer<u32>,
    /// `[LANES][count]`
    distance: Buffer<f32>,
    /// `[LANES][count]`
    candidates: Buffer<u32>,
    matched: Buffer<u32>,
    near: search_seed::Params,
    leaf_codes: u32,
    range: f32,
    blur: f32,
}

/// Leaves between two looks at what is still within reach: fewer find more out of reach, more need
/// fewer launches.
const SLICE: u32 = 512;
/// Leaves an invocation of `search_reach` looks at.
const RUN: u32 = 256;

impl Indexed {
    /// For batches of `count` queries.
    pub fn new(gpu: &Gpu, index: &Index, count: usize) -> Self {
        let packed = Packed::of(index);
        let codes: Vec<u32> = bytemuck::pod_collect_to_vec(&packed.codes);
        let coarse: Vec<u32> = bytemuck::pod_collect_to_vec(packed.coarse.as_flattened());
        Indexed {
            rows: Buffer::from_slice(gpu, packed.rows.as_flattened()),
            coarse: Buffer::from_slice(gpu, &coarse),
            boxes: Buffer::from_slice(gpu, packed.boxes.as_flattened()),
            codes: Buffer::from_slice(gpu, &codes),
            asked: Buffer::zeroed(gpu, ASKED * count),
            reach: Buffer::zeroed(gpu, SLICE as usize / 32 * count),
            distance: Buffer::zeroed(gpu, LANES * count),
            candidates: Buffer::zeroed(gpu, LANES * count),
            matched: Buffer::zeroed(gpu, count),
            near: search_seed::Params {
                count: count as u32,
                groups: packed.groups,
                frames: packed.frames,
                step: packed.step,
                longest: packed.longest,
            },
            leaf_codes: packed.leaf_codes,
            range: packed.range,
            blur: packed.blur,
        }
    }

    /// Nearest candidate of every query `[count][ROW_STRIDE]`, whose pose is that of the frame `shown`.
    pub fn nearest(&self, gpu: &Gpu, shown: &Buffer<u32>, queries: &Buffer<f32>) -> &Buffer<u32> {
        search_seed::launch(
            gpu,
            &self.rows,
            &self.boxes,
            &self.codes,
            shown,
            queries,
            &self.asked,
            &self.distance,
            &self.candidates,
            &self.near,
        );
        let leaves = self.near.groups * GROUP as u32;
        for first in (0..leaves).step_by(SLICE as usize) {
            let last = leaves.min(first + SLICE);
            self.reach(gpu, shown, first, last);
            self.compare(gpu, queries, first, last);
        }
        let params = search_argmin::Params {
            count: self.near.count,
        };
        let (distance, candidates) = (&self.distance, &self.candidates);
        search_argmin::launch(gpu, distance, candidates, &self.matched, &params);
        &self.matched
    }

    fn reach(&self, gpu: &Gpu, shown: &Buffer<u32>, first: u32, last: u32) {
        search_prune::launch(
            gpu,
            &self.boxes,
            &self.codes,
            shown,
            &self.asked,
            &self.distance,
            &self.reach,
            &search_prune::Params {
                count: self.near.count,
                groups: self.near.groups,
                first,
                last,
                run: RUN,
                frames: self.near.frames,
                leaf_codes: self.leaf_codes,
                step: self.near.step,
            },
        );
    }

    fn compare(&self, gpu: &Gpu, queries: &Buffer<f32>, first: u32, last: u32) {
        search_leaves::launch(
            gpu,
            &self.rows,
            &self.coarse,
            queries,
            &self.asked,
            &self.reach,
            &self.distance,
            &self.candidates,
            &search_leaves::Params {
                count: self.near.count,
                first,
                last,
                range: self.range,
                blur: self.blur,
            },
        );
    }
}
