//! What to measure.

use crate::gpu::Choice;
use std::path::Path;

/// Names for `--filter`.
pub const STAGES: [&str; 12] = [
    "memory",
    "arithmetic",
    "search",
    "rasterize_maps",
    "hits",
    "environment",
    "physics",
    "self_play",
    "network",
    "gradient",
    "training",
    "drawing",
];

/// What to measure.
pub struct BenchPlan<'a> {
    /// Stages with this in their name.
    pub filter: &'a str,
    /// `Auto`: every device there is.
    pub device: Choice,
    /// A database file, a BVH file or a folder of them.
    pub data: Option<&'a Path>,
}

impl BenchPlan<'_> {
    /// Whether a stage is to be measured.
    pub fn selects(&self, stage: &str) -> bool {
        stage.contains(self.filter)
    }
}
