//! The search over the whole database on the GPU, in the form that suits the adapter: by the index
//! where every multiplication counts, all rows where a tile of them costs as much as one.

pub mod brute_force;
pub mod indexed;
pub mod packed_index;

use super::MotionMatcher;
use crate::gpu::{Buffer, Gpu};
use brute_force::BruteForceSearch;
use indexed::IndexedSearch;

/// The search on a GPU for batches of one size.
#[cfg_attr(
    feature = "gpu",
    expect(clippy::large_enum_variant, reason = "one a batch, never moved")
)]
pub enum GpuSearch {
    /// By the index: for software adapters.
    Indexed(IndexedSearch),
    /// Over all rows: for real GPUs.
    BruteForce(BruteForceSearch),
}

impl GpuSearch {
    /// The search for batches of `count` queries.
    pub fn new(gpu: &Gpu, matcher: &MotionMatcher, count: usize) -> Self {
        match &matcher.index {
            Some(index) if gpu.software => {
                GpuSearch::Indexed(IndexedSearch::new(gpu, index, count))
            }
            _ => GpuSearch::BruteForce(BruteForceSearch::new(gpu, &matcher.database.rows(), count)),
        }
    }

    /// Nearest candidate of every query `[count][ROW_STRIDE]`, whose last number must be 1, and whose
    /// pose is that of the frame `shown`.
    pub fn nearest(&self, gpu: &Gpu, shown: &Buffer<u32>, queries: &Buffer<f32>) -> &Buffer<u32> {
        match self {
            GpuSearch::Indexed(search) => search.nearest(gpu, shown, queries),
            GpuSearch::BruteForce(search) => search.nearest(gpu, queries),
        }
    }
}
