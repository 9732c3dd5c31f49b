//! A run's folder and the files in it.

use super::config::Config;
use super::evaluation::Evaluation;
use crate::container::{UNFINISHED, write_whole};
use anyhow::{Context, Result, bail};
use serde::Serialize;
use std::fs::{File, TryLockError};
use std::io::{self, ErrorKind, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

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
    /// Processes that trained together.
    pub ranks: usize,
    /// Fraction of the time, since the latest start, in which the first of them talked to the others, and waited for them.
    pub communication_share: f64,
    /// Checksum of the policy's parameters.
    pub parameters_hash: u32,
    /// `steps`, `time`, `success`, `interrupt` or `failure`.
    pub stopped_by: &'static str,
}

/// A run's folder: `config.toml`, `metrics.jsonl`, TensorBoard events, `checkpoints/`, pictures,
/// `summary.json`.
#[derive(Clone, Debug)]
pub struct RunDir {
    path: PathBuf,
    /// Held while the run is written.
    lock: Option<Arc<File>>,
}

/// Locked by who writes the run, whose process it names.
const LOCK: &str = "run.lock";

/// A checkpoint that is named itself, or by its run's folder: the last there.
///
/// # Errors
/// There is none.
pub fn checkpoint_of(run: &Path) -> Result<PathBuf> {
    match run.is_file() {
        true => Ok(run.to_path_buf()),
        false => RunDir::open(run)?.last(),
    }
}

impl RunDir {
    /// Makes and claims the folder of a new run: the given one, or the next free `runs/TASK-N`.
    ///
    /// # Errors
    /// It cannot be made, or holds a run.
    pub fn create(given: Option<&Path>, task: &str) -> Result<Self> {
        let path = match given {
            Some(path) => path.to_path_buf(),
            None => free_folder(task)?,
        };
        let run = RunDir { path, lock: None };
        std::fs::create_dir_all(run.checkpoints())
            .inspect_err(|_| run.discard())
            .with_context(|| format!("cannot make the run folder {}", run.path.display()))?;
        let run = run.claimed()?;
        if run.config_path().exists() {
            bail!(
                "{} already holds a run: go on with `--resume {0}`, or choose another --out",
                run.path.display()
            );
        }
        Ok(run)
    }

    /// Claims the run for writing until the value is dropped, and clears what a killed process left half
    /// written.
    ///
    /// # Errors
    /// Another process writes it.
    pub fn claimed(mut self) -> Result<Self> {
        let path = self.file(LOCK);
        let open = File::options()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path);
        let mut file = open.with_context(|| format!("cannot write {}", path.display()))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                let mut holder = String::new();
                // Who it is would be good to know; that there is somebody is enough.
                let _ = file.read_to_string(&mut holder);
                bail!(
                    "{} is being written by process {}: wait for its end or stop it, or choose another --out",
                    self.path.display(),
                    holder.trim()
                );
            }
            // Where the file system knows no locks, there are none.
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        // Who holds it is for people; the lock is what counts.
        let _ = file
            .set_len(0)
            .and_then(|()| file.rewind())
            .and_then(|()| writeln!(file, "{}", std::process::id()));
        self.lock = Some(Arc::new(file));
        for folder in [&self.path, &self.checkpoints()] {
            clear_unfinished(folder);
        }
        Ok(self)
    }

    /// Takes the folder away again, if no run came of it; what else it holds stays.
    pub fn discard(&self) {
        // The error that led here is the one to tell.
        if !self.config_path().exists() {
            let begun = [
                self.metrics_path(),
                self.file(LOCK),
                self.checkpoint("last"),
            ];
            for file in begun {
                let _ = std::fs::remove_file(file);
            }
            #[cfg(feature = "report")]
            let _ = std::fs::remove_file(self.file(crate::report::events::FILE_NAME));
        }
        let _ = std::fs::remove_dir(self.checkpoints());
        let _ = std::fs::remove_dir(&self.path);
    }

    /// The folder of a run that another rank writes.
    pub fn of_first(path: &Path) -> Self {
        RunDir {
            path: path.to_path_buf(),
            lock: None,
        }
    }

    /// An existing run.
    pub fn open(path: &Path) -> Result<Self> {
        if !path.is_dir() {
            bail!(
                "{} is not a run folder: give one that `footwork train` has made",
                path.display()
            );
        }
        let run = RunDir {
            path: path.to_path_buf(),
            lock: None,
        };
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
        &self.path
    }

    /// Where a file of the run is.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Where its configuration is.
    pub fn config_path(&self) -> PathBuf {
        self.file("config.toml")
    }

    /// Where its updates are, one a line.
    pub fn metrics_path(&self) -> PathBuf {
        self.file("metrics.jsonl")
    }

    /// Where the summary of its end is.
    pub fn summary_path(&self) -> PathBuf {
        self.file("summary.json")
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
                "{} is missing: name one of the other checkpoints there, if there is one, or start the run again \
                 with another --out",
                last.display()
            );
        }
        Ok(last)
    }

    /// The periodic checkpoint at a number of steps; the names sort like the numbers.
    pub fn checkpoint_at(&self, steps: u64) -> PathBuf {
        self.checkpoint(&name_at(steps))
    }

    /// Where pictures of policies are, a folder a kind.
    pub fn pictures(&self) -> PathBuf {
        self.file("pictures")
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
        Ok(write_whole(&self.summary_path(), text.as_bytes())?)
    }
}

/// What is kept of a number of steps; the names sort like the numbers.
pub fn name_at(steps: u64) -> String {
    format!("steps-{steps:010}")
}

/// Makes the next free `runs/TASK-N`: of two processes that ask at once, each gets its own.
fn free_folder(task: &str) -> Result<PathBuf> {
    let runs = Path::new("runs");
    let made = |path: &Path| -> io::Result<bool> {
        std::fs::create_dir_all(runs)?;
        match std::fs::create_dir(path) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => Ok(false),
            Err(error) => Err(error),
        }
    };
    for n in 1u64.. {
        let path = runs.join(format!("{task}-{n}"));
        let made = made(&path);
        if made.with_context(|| format!("cannot make the run folder {}", path.display()))? {
            return Ok(path);
        }
    }
    bail!("no free name under {}", runs.display())
}

/// Removes files that were being written when their process died. Nobody else writes here.
fn clear_unfinished(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for entry in entries.filter_map(Result::ok) {
        if entry.file_name().to_string_lossy().starts_with(UNFINISHED) {
            // One that stays costs space, no more.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}
