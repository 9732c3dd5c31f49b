//! A run's folder and the files in it.

use super::config::Config;
use super::evaluation::Evaluation;
use crate::container::write_whole;
use anyhow::{Context, Result, bail};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// How a training ended, written as `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The program that wrote it.
    pub version: &'static str,
    /// Environment steps, over all resumptions.
    pub steps: u64,
    /// Seconds of training, over all resumptions.
    pub wall_s: f64,
    /// Environment steps a second.
    pub steps_per_s: f64,
    /// Over the evaluation episodes, at the end: success, and what else the task measures. Nothing
    /// succeeds after a failure.
    #[serde(flatten)]
    pub evaluation: Evaluation,
    /// Level of the curriculum at the end; the success is of the hardest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level: Option<u32>,
    /// Levels of the curriculum passed by the end: all of them, if the hardest was passed too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub levels_passed: Option<u32>,
    /// What it was trained on.
    pub device: String,
    /// Seed of the run.
    pub seed: u32,
    /// `steps`, `time`, `success`, `interrupt` or `failure`.
    pub stopped_by: &'static str,
}

/// A run's folder: `config.toml`, `metrics.jsonl`, TensorBoard events, `checkpoints/`, pictures,
/// `summary.json`.
#[derive(Clone, Debug)]
pub struct RunDir(PathBuf);

impl RunDir {
    /// Makes the folder of a new run: the given one, or the next free `runs/TASK-N`.
    pub fn create(given: Option<&Path>, task: &str) -> Result<Self> {
        let path = match given {
            Some(path) => path.to_path_buf(),
            None => {
                let free = (1..)
                    .map(|n| Path::new("runs").join(format!("{task}-{n}")))
                    .find(|p| !p.exists());
                free.context("no free name under runs/")?
            }
        };
        if path.join("config.toml").exists() {
            bail!(
                "{} already holds a run: go on with `--resume {0}`, or choose another --out",
                path.display()
            );
        }
        let run = RunDir(path);
        std::fs::create_dir_all(run.checkpoints())
            .inspect_err(|_| run.remove_empty())
            .with_context(|| format!("cannot make the run folder {}", run.0.display()))?;
        Ok(run)
    }

    /// Takes the folder away again, if nothing could be written to it.
    pub fn remove_empty(&self) {
        // Folders that hold something stay; the error that led here is the one to tell.
        let _ = std::fs::remove_dir(self.checkpoints());
        let _ = std::fs::remove_dir(&self.0);
    }

    /// An existing run.
    pub fn open(path: &Path) -> Result<Self> {
        if !path.is_dir() {
            bail!(
                "{} is not a run folder: give one that `footwork train` has made",
                path.display()
            );
        }
        let run = RunDir(path.to_path_buf());
        if !run.config_path().exists() {
            bail!(
                "{} holds no run: its config.toml is missing",
                path.display()
            );
        }
        Ok(run)
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Where a file of the run is.
    pub fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Where its configuration is.
    pub fn config_path(&self) -> PathBuf {
        self.file("config.toml")
    }

    fn checkpoints(&self) -> PathBuf {
        self.file("checkpoints")
    }

    /// `last`, `best` or `steps-N`.
    pub fn checkpoint(&self, name: &str) -> PathBuf {
        self.checkpoints().join(format!("{name}.ckpt"))
    }

    /// The checkpoint that the run goes on from.
    ///
    /// # Errors
    /// The run ended before its first.
    pub fn last(&self) -> Result<PathBuf> {
        let last = self.checkpoint("last");
        if !last.exists() {
            bail!(
                "{} is missing: the run was stopped before it was saved; start it again with another --out, \
                 or name one of the other checkpoints there, if there is one",
                last.display()
            );
        }
        Ok(last)
    }

    /// The periodic checkpoint at a number of steps; the names sort like the numbers.
    pub fn checkpoint_at(&self, steps: u64) -> PathBuf {
        self.checkpoint(&format!("steps-{steps:010}"))
    }

    /// All checkpoints, the periodic ones first and in order.
    ///
    /// # Errors
    /// Their folder cannot be read.
    pub fn checkpoint_files(&self) -> Result<Vec<PathBuf>> {
        let folder = self.checkpoints();
        let entries = std::fs::read_dir(&folder);
        let entries = entries.with_context(|| format!("cannot read {}", folder.display()))?;
        let mut files: Vec<PathBuf> = entries
            .filter_map(|entry| Some(entry.ok()?.path()))
            .filter(|path| path.extension().is_some_and(|ending| ending == "ckpt"))
            .collect();
        let periodic = |path: &PathBuf| {
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            name.starts_with("steps-")
        };
        files.sort_by_key(|path| (!periodic(path), path.clone()));
        Ok(files)
    }

    /// Writes `config.toml`.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write_config(&self, config: &Config) -> Result<()> {
        let text = config.to_toml();
        Ok(write_whole(&self.config_path(), text.as_bytes())?)
    }

    /// Writes `summary.json`.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write_summary(&self, summary: &Summary) -> Result<()> {
        let text = serde_json::to_string_pretty(summary)? + "\n";
        Ok(write_whole(&self.file("summary.json"), text.as_bytes())?)
    }
}
