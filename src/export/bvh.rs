//! Runs as BVH files.

use super::episode::characters;
use super::format::{ExportFormat, TrainedRun};
use crate::motion::bvh::to_text;
use anyhow::Result;

/// The format in the list.
pub const FORMAT: ExportFormat = ExportFormat {
    name: "bvh",
    about: "One of the evaluation's episodes as motion capture, for Blender and others; of a bout the first fighter",
    carries: |_| true,
    carried: "runs of every task",
    motion: true,
    write,
};

/// A BVH file has one skeleton: that of the first character.
fn write(run: &TrainedRun) -> Result<Vec<u8>> {
    Ok(to_text(&characters(run)?[0].clip)?.into_bytes())
}
