//! A trained run, opened.

use super::Usage;
use anyhow::{Context, Result};
use clap::Args;
use footwork::env::EnvSpec;
use footwork::train::checkpoint::{Checkpoint, CheckpointError};
use footwork::train::config::Config;
#[cfg(feature = "viewer")]
use footwork::train::locomotion::Locomotion;
use footwork::train::run_dir::RunDir;
use footwork::train::task::Task;
#[cfg(feature = "viewer")]
use footwork::train::task::Unsupported;
use footwork::train::tasks::{config_of, find};
use std::path::{Path, PathBuf};

/// A run with its task, its data, and the path of one of its checkpoints.
pub struct Run {
    #[cfg(feature = "viewer")]
    pub folder: RunDir,
    pub config: Config,
    pub spec: EnvSpec,
    pub task: Box<dyn Task>,
    /// The given checkpoint, or the last of a given folder.
    pub path: PathBuf,
}

impl Run {
    /// Opens a run's folder, or one of its checkpoints; what it was trained with is where it was, or has moved.
    pub fn open(run: &Path, moved: Moved) -> Result<Run> {
        let (folder, path) = locate(run)?;
        let mut config = config_of(&folder)?;
        let entry = find(&config.task.name)?;
        moved.find(&mut config)?;
        let spec = entry.check(&config)?;
        // What is to be said of the data was said when the training started.
        let task = (entry.load)(&config)?.task;
        Ok(Run {
            #[cfg(feature = "viewer")]
            folder,
            config,
            spec,
            task,
            path,
        })
    }

    /// One of the run's checkpoints.
    pub fn checkpoint(&self, path: &Path) -> Result<Checkpoint, CheckpointError> {
        let (task, fingerprint) = (&self.config.task.name, self.task.fingerprint());
        Checkpoint::load_for(path, task, &self.spec, fingerprint)
    }

    /// What only runs of motion matching have; `wanted` is who asks for it.
    #[cfg(feature = "viewer")]
    pub fn locomotion(&self, wanted: &str) -> Result<&Locomotion, Unsupported> {
        let name = &self.config.task.name;
        let why = || {
            Unsupported(format!(
                "`{wanted}` shows motion matching, which `{name}` is not of"
            ))
        };
        self.task.locomotion().ok_or_else(why)
    }
}

/// Options for files that have been moved.
#[derive(Args)]
pub struct MovedFiles {
    /// Where the run's motion is now, if it has been moved
    #[arg(long, value_name = "DIR|FILE")]
    data: Option<PathBuf>,
    /// Where the low level is now that the run steers, if it has been moved
    #[arg(long, value_name = "RUN")]
    skills: Option<PathBuf>,
}

impl MovedFiles {
    pub fn moved(&self) -> Moved<'_> {
        Moved {
            data: self.data.as_deref(),
            skills: self.skills.as_deref(),
        }
    }
}

/// Where the files are now that a run was trained with, if they have been moved.
#[derive(Clone, Copy)]
pub struct Moved<'a> {
    pub data: Option<&'a Path>,
    pub skills: Option<&'a Path>,
}

impl Moved<'_> {
    /// Makes sure that a run's motion and its low level are where its configuration says, or where they are said to
    /// have been moved to.
    pub fn find(&self, config: &mut Config) -> Result<()> {
        if self.skills.is_some() && config.skills.is_none() {
            let why = "the run steers no low level: leave out --skills";
            return Err(Usage(why.into()).into());
        }
        for (what, place, moved, option) in [
            ("motion", &mut config.data, self.data, "--data"),
            ("low level", &mut config.skills, self.skills, "--skills"),
        ] {
            if let Some(moved) = moved {
                // A run must find them again from any folder.
                *place = Some(std::path::absolute(moved)?);
            } else if let Some(gone) = place.as_deref().filter(|path| !path.exists()) {
                anyhow::bail!(
                    "the {what} that the run was trained with is gone: it was {}; say where it is now with {option}",
                    gone.display()
                );
            }
        }
        Ok(())
    }
}

/// The run's folder, and the checkpoint: the given one, or the last of a given folder.
pub fn locate(run: &Path) -> Result<(RunDir, PathBuf)> {
    if run.is_file() {
        let whole = std::path::absolute(run)?;
        let folder = whole.ancestors().nth(2).map(RunDir::open);
        let folder = folder.and_then(Result::ok).with_context(|| {
            format!(
                "{} is not in the checkpoints of a run: give a run's folder, or one of its checkpoints where it was written",
                run.display()
            )
        })?;
        return Ok((folder, run.to_path_buf()));
    }
    let folder = RunDir::open(run)?;
    let last = folder.last()?;
    Ok((folder, last))
}
