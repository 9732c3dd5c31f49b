//! One of the trainings that are compared.

use super::{ComparedRun, Comparison, FinishedRun, Outcome};
use crate::ranks::Ranks;
use crate::train::checkpoint::Checkpoint;
use crate::train::config::Config;
use crate::train::known_summary::KnownSummary;
use crate::train::metrics;
use crate::train::observer::Observer;
use crate::train::run_dir::{RunDir, Summary};
use crate::train::tasks::config_of;
use crate::train::trainer::{Training, train};
use anyhow::{Context, Result, anyhow, bail};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

impl Comparison<'_> {
    /// Does a training to its end, from wherever it is. None if it was interrupted.
    ///
    /// # Errors
    /// Its folder cannot be made or read, is written by another process, or holds a run of other choices. That the
    /// training fails is no error, but its outcome.
    pub fn train_one(
        &self,
        run: ComparedRun,
        interrupted: &AtomicBool,
        observer: &mut (dyn Observer + Send),
    ) -> Result<Option<Outcome>> {
        let contestant = &self.contestants[run.contestant];
        let config = contestant.config(run.seed);
        let (folder, from) = self.open(run, &config)?;
        let known = KnownSummary::read(&folder).filter(|_| from.is_some());
        if !known.is_some_and(|summary| summary.is_final(&config)) {
            if interrupted.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let training = Training {
                config: &config,
                task: &*contestant.task,
                run: &folder,
                device: self.device,
                // Ranks share out trainings, each of which is one rank's.
                ranks: &Ranks::alone(),
                start: contestant.start,
            };
            self.announce(run, &config, observer);
            match contained(|| train(training, from, interrupted, observer)) {
                Ok(summary) if summary.stopped_by == "interrupt" => return Ok(None),
                Ok(_) => {}
                Err(error) => {
                    let why = format!("{error:#}");
                    observer.noted(&format!("{} failed: {why}", self.folder(run)));
                    let result = Err(why);
                    return Ok(Some(Outcome { run, result }));
                }
            }
        }
        let result = Ok(self.finished(run, &config, &folder)?);
        Ok(Some(Outcome { run, result }))
    }

    /// The folder of a training.
    pub(super) fn path(&self, run: ComparedRun) -> PathBuf {
        self.out.join(self.folder(run))
    }

    /// The folder's name.
    pub(super) fn folder(&self, run: ComparedRun) -> String {
        let contestant = &self.contestants[run.contestant];
        format!("{}-{}", contestant.folder(), run.seed)
    }

    /// Says which training begins.
    fn announce(&self, run: ComparedRun, config: &Config, observer: &mut (dyn Observer + Send)) {
        let all = self.contestants.len() * self.seeds as usize;
        let number = (run.seed as usize - 1) * self.contestants.len() + run.contestant + 1;
        let path = self.path(run);
        observer.noted(&format!("{}, {number} of {all}", path.display()));
        observer.begins(&self.folder(run), config);
    }

    /// Refuses a run of other choices in a training's folder.
    pub(super) fn check_same(&self, run: ComparedRun) -> Result<()> {
        let path = self.path(run);
        if !path.join("config.toml").exists() {
            return Ok(());
        }
        let config = self.contestants[run.contestant].config(run.seed);
        let found = Config {
            steps: config.steps,
            ..config_of(&RunDir::open(&path)?)?
        };
        if found != config {
            bail!(
                "{} holds a run of another configuration: give another --out, or what that one was given",
                path.display()
            );
        }
        Ok(())
    }

    /// The folder of a training, made or claimed, and the last checkpoint there, if an earlier call has begun it.
    fn open(&self, run: ComparedRun, config: &Config) -> Result<(RunDir, Option<Checkpoint>)> {
        let path = self.path(run);
        if !path.join("config.toml").exists() {
            return Ok((RunDir::create(Some(&path), self.entry.name)?, None));
        }
        let folder = RunDir::open(&path)?.claimed()?;
        if !folder.checkpoint("last").exists() {
            return Ok((folder, None));
        }
        let spec = self.entry.check(config)?;
        let fingerprint = self.contestants[run.contestant].task.fingerprint();
        let last = folder.last()?;
        let checkpoint = Checkpoint::load_for(&last, self.entry.name, &spec, fingerprint)?;
        let done = checkpoint.header.steps;
        if done >= config.steps + config.batch() {
            bail!(
                "{} has done {done} steps, more than are asked for: give --steps {done}, or another --out",
                path.display()
            );
        }
        Ok((folder, Some(checkpoint)))
    }

    /// What a training has left in its folder.
    fn finished(&self, run: ComparedRun, config: &Config, folder: &RunDir) -> Result<FinishedRun> {
        let summary = KnownSummary::read(folder);
        let path = folder.summary_path();
        let summary = summary.with_context(|| format!("cannot read {}", path.display()))?;
        let up_to = config.steps + config.batch();
        let mut rows = metrics::read(&folder.metrics_path(), up_to)?.rows;
        let each = self.contestants[run.contestant].body_steps;
        rows.iter_mut().for_each(|row| row.steps *= each);
        Ok(FinishedRun { rows, summary })
    }
}

/// A training whose panic is its failure, and nobody else's.
fn contained(train: impl FnOnce() -> Result<Summary>) -> Result<Summary> {
    let outcome = catch_unwind(AssertUnwindSafe(train));
    outcome.unwrap_or_else(|panic| Err(anyhow!("a bug: {}", message(&*panic))))
}

fn message(panic: &(dyn Any + Send)) -> String {
    let fixed = panic.downcast_ref::<&str>().map(ToString::to_string);
    let made = || panic.downcast_ref::<String>().cloned();
    fixed.or_else(made).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_failure_with_its_message() {
        let failed = contained(|| panic!("index {} of nothing", 3));
        assert_eq!(failed.unwrap_err().to_string(), "a bug: index 3 of nothing");
        let failed = contained(|| bail!("the losses are no longer finite"));
        assert!(failed.unwrap_err().to_string().ends_with("finite"));
    }
}
