//! The search over the whole database on the GPU, in the form that suits the adapter: by the index
//! where every multiplication counts, all rows where a tile of them costs as much as one.

pub mod brute_force;
pub mod indexed;

use crate::gpu::{Buffer, Gpu};
use brute_force::Brute;
use indexed::Indexed;
use crate::motion::database::Database;

#[expect(clippy::large_enum_variant, reason = "one a world, never moved")]
pub enum Search {
    Indexed(Indexed),
    Brute(Brute),
}

impl Search {
    /// For batches of `count` queries.
    pub fn new(gpu: &Gpu, database: &Database, count: usize) -> Self {
        match gpu.software {
            true => Search::Indexed(Indexed::new(gpu, &database.index(), count)),
            false => Search::Brute(Brute::new(gpu, &database.rows(), count)),
        }
    }

    /// Nearest candidate of every query `[count][ROW_STRIDE]`, whose last number must be 1, and whose
    /// pose is that of the frame `shown`.
    pub fn nearest(&self, gpu: &Gpu, shown: &Buffer<u32>, queries: &Buffer<f32>) -> &Buffer<u32> {
        match self {
            Search::Indexed(search) => search.nearest(gpu, shown, queries),
            Search::Brute(search) => search.nearest(gpu, queries),
        }
    }
}
