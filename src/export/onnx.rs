//! Policies as ONNX files.

use super::format::{ExportFormat, TrainedRun};
use anyhow::{Result, bail};

/// The format in the list.
pub const FORMAT: ExportFormat = ExportFormat {
    name: "onnx",
    about: "The policy as a network for ONNX Runtime and engines, with all that is needed to run it",
    carries: |_| true,
    carried: "runs of every task",
    write,
};

fn write(_run: &TrainedRun) -> Result<Vec<u8>> {
    bail!("onnx files cannot be written yet")
}
