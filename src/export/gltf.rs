//! Runs as glTF files.

use super::format::{ExportFormat, TrainedRun};
use anyhow::{Result, bail};

/// The format in the list.
pub const FORMAT: ExportFormat = ExportFormat {
    name: "gltf",
    about: "One of the evaluation's episodes as an animated, skinned body",
    carries: |_| true,
    carried: "runs of every task",
    write,
};

fn write(_run: &TrainedRun) -> Result<Vec<u8>> {
    bail!("gltf files cannot be written yet")
}
