//! Runs as BVH files.

use super::format::{ExportFormat, TrainedRun};
use anyhow::{Result, bail};

/// The format in the list.
pub const FORMAT: ExportFormat = ExportFormat {
    name: "bvh",
    about: "One of the evaluation's episodes as motion capture, for Blender and others",
    carries: |_| true,
    carried: "runs of every task",
    write,
};

fn write(_run: &TrainedRun) -> Result<Vec<u8>> {
    bail!("bvh files cannot be written yet")
}
