//! Runs of simulated bodies as MJCF files.

use super::format::{ExportFormat, TrainedRun};
use crate::physics::mjcf::to_text;
use anyhow::{Result, bail};

/// The format in the list.
pub const FORMAT: ExportFormat = ExportFormat {
    name: "mjcf",
    about: "The simulated body as a model for MuJoCo",
    carries: |run| run.task.body().is_some(),
    carried: "runs of simulated bodies",
    motion: false,
    write,
};

/// What the task's environments simulate.
fn write(run: &TrainedRun) -> Result<Vec<u8>> {
    let Some(body) = run.task.body() else {
        bail!("the task simulates nothing");
    };
    Ok(to_text(body.open(0).task().model())?.into_bytes())
}
