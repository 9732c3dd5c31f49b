//! The search on the GPU by the index, for software adapters.

use super::packed_index::PackedIndex;
use crate::gpu::{Buffer, Gpu};
use crate::kernels::search::search_index::{GROUP, LANES, PROJECTION_LEN};
use crate::kernels::search::{search_argmin, search_leaves, search_prune, search_seed};
use crate::matching::Index;

/// The index on the device, and what the search needs for batches of one size.
pub struct IndexedSearch {
    rows: Buffer<f32>,
    quantised_rows: Buffer<u32>,
    boxes: Buffer<f32>,
    distance_codes: Buffer<u32>,
    /// `[PROJECTION_LEN][count]`
    query_projection: Buffer<f32>,
    /// `[SLICE / 32][count]`
    leaf_mask: Buffer<u32>,
    /// `[LANES][count]`
    distance: Buffer<f32>,
    /// `[LANES][count]`
    candidates: Buffer<u32>,
    matched: Buffer<u32>,
    seed: search_seed::Params,
    leaf_codes: u32,
    range: f32,
    quantisation_error: f32,
}

/// Leaves pruned and compared at a time: with fewer, later ones are pruned by nearer rows; with more,
/// there are fewer launches.
const SLICE: u32 = 512;
/// Leaves an invocation of `search_prune` tests.
const RUN: u32 = 256;

impl IndexedSearch {
    /// For batches of `count` queries.
    pub fn new(gpu: &Gpu, index: &Index, count: usize) -> Self {
        let packed = PackedIndex::of(index);
        let distance_codes: Vec<u32> = bytemuck::pod_collect_to_vec(&packed.distance_codes);
        let quantised_rows: Vec<u32> =
            bytemuck::pod_collect_to_vec(packed.quantised_rows.as_flattened());
        IndexedSearch {
            rows: Buffer::from_slice(gpu, packed.rows.as_flattened()),
            quantised_rows: Buffer::from_slice(gpu, &quantised_rows),
            boxes: Buffer::from_slice(gpu, packed.boxes.as_flattened()),
            distance_codes: Buffer::from_slice(gpu, &distance_codes),
            query_projection: Buffer::zeroed(gpu, PROJECTION_LEN * count),
            leaf_mask: Buffer::zeroed(gpu, SLICE as usize / 32 * count),
            distance: Buffer::zeroed(gpu, LANES * count),
            candidates: Buffer::zeroed(gpu, LANES * count),
            matched: Buffer::zeroed(gpu, count),
            seed: search_seed::Params {
                count: count as u32,
                groups: packed.groups,
                frames: packed.frames,
                step: packed.step,
                max_norm: packed.max_norm,
            },
            leaf_codes: packed.leaf_codes,
            range: packed.range,
            quantisation_error: packed.quantisation_error,
        }
    }

    /// Nearest candidate of every query `[count][ROW_STRIDE]`, whose pose is that of the frame `shown`.
    pub fn nearest(&self, gpu: &Gpu, shown: &Buffer<u32>, queries: &Buffer<f32>) -> &Buffer<u32> {
        search_seed::launch(
            gpu,
            &self.rows,
            &self.boxes,
            &self.distance_codes,
            shown,
            queries,
            &self.query_projection,
            &self.distance,
            &self.candidates,
            &self.seed,
        );
        let leaves = self.seed.groups * GROUP as u32;
        for first in (0..leaves).step_by(SLICE as usize) {
            let last = leaves.min(first + SLICE);
            self.prune(gpu, shown, first, last);
            self.compare(gpu, queries, first, last);
        }
        let params = search_argmin::Params {
            count: self.seed.count,
        };
        let (distance, candidates) = (&self.distance, &self.candidates);
        search_argmin::launch(gpu, distance, candidates, &self.matched, &params);
        &self.matched
    }

    fn prune(&self, gpu: &Gpu, shown: &Buffer<u32>, first: u32, last: u32) {
        search_prune::launch(
            gpu,
            &self.boxes,
            &self.distance_codes,
            shown,
            &self.query_projection,
            &self.distance,
            &self.leaf_mask,
            &search_prune::Params {
                count: self.seed.count,
                groups: self.seed.groups,
                first,
                last,
                run: RUN,
                frames: self.seed.frames,
                leaf_codes: self.leaf_codes,
                step: self.seed.step,
            },
        );
    }

    fn compare(&self, gpu: &Gpu, queries: &Buffer<f32>, first: u32, last: u32) {
        search_leaves::launch(
            gpu,
            &self.rows,
            &self.quantised_rows,
            queries,
            &self.query_projection,
            &self.leaf_mask,
            &self.distance,
            &self.candidates,
            &search_leaves::Params {
                count: self.seed.count,
                first,
                last,
                range: self.range,
                quantisation_error: self.quantisation_error,
            },
        );
    }
}
