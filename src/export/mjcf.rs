//! Runs as MJCF files.

use super::format::{ExportFormat, TrainedRun};
use anyhow::{Result, bail};

/// The format in the list.
pub const FORMAT: ExportFormat = ExportFormat {
    name: "mjcf",
    about: "The simulated body as a model for MuJoCo",
    carries: |run| run.task.body().is_some(),
    carried: "runs of simulated bodies",
    write,
};

fn write(_run: &TrainedRun) -> Result<Vec<u8>> {
    bail!("mjcf files cannot be written yet")
}
