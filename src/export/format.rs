//! What a format is, and what it is given.

use crate::train::checkpoint::Checkpoint;
use crate::train::config::Config;
use crate::train::task::Task;
use anyhow::Result;

/// A run with one of its checkpoints.
#[derive(Clone, Copy)]
pub struct TrainedRun<'a> {
    /// Its configuration.
    pub config: &'a Config,
    /// Its task, with its data.
    pub task: &'a dyn Task,
    /// What it had learned by then.
    pub checkpoint: &'a Checkpoint,
}

/// A kind of file that runs are exported to.
pub struct ExportFormat {
    /// On the command line.
    pub name: &'static str,
    /// A line for `--help`.
    pub about: &'static str,
    /// Whether it can carry a run of that kind.
    pub carries: fn(&TrainedRun) -> bool,
    /// The kinds of runs that it can carry, in words.
    pub carried: &'static str,
    /// The bytes of the file.
    pub write: fn(&TrainedRun) -> Result<Vec<u8>>,
}
