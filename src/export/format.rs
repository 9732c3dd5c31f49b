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
    /// What is played, in formats of motion.
    pub excerpt: Excerpt,
}

/// Which of the evaluation's episodes, and how much of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excerpt {
    /// Number of the episode.
    pub episode: usize,
    /// Length from its start on, s. It is shorter if the episode ends before; who reaches the target of motion
    /// matching goes on to another.
    pub seconds: f32,
}

impl Excerpt {
    /// Frames at so many a second, at least one.
    pub fn frames(&self, rate: f32) -> usize {
        ((self.seconds * rate).round() as usize).max(1)
    }
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
    /// Whether it is a format of motion.
    pub motion: bool,
    /// The bytes of the file.
    pub write: fn(&TrainedRun) -> Result<Vec<u8>>,
}
