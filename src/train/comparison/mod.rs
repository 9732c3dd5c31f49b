//! Ways to learn a task side by side, trained from several seeds each and evaluated on the same episodes.

mod one_run;
mod stats;
mod tables;

use super::checkpoint::Checkpoint;
use super::config::Config;
use super::known_summary::KnownSummary;
use super::metrics::UpdateMetrics;
use super::observer::Observer;
use super::task::{Measure, Task, TaskEntry};
use crate::gpu::Device;
use crate::ranks::Ranks;
use anyhow::{Result, bail};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

/// Trainings side by side.
pub struct Comparison<'a> {
    /// What the files with the figures are called.
    pub title: &'static str,
    /// The task that all learn.
    pub entry: &'a TaskEntry,
    /// Who is compared; the first is what the others are compared with.
    pub contestants: Vec<Contestant<'a>>,
    /// Trainings of each contestant, from the seeds 1, 2, ..
    pub seeds: u32,
    /// What is compared besides the success.
    pub measures: &'static [Measure],
    /// Rates of episodes in `metrics.jsonl` whose curves are kept.
    pub rates: &'static [&'static str],
    /// The device that all are trained on.
    pub device: &'a Device,
    /// Who shares in the trainings.
    pub ranks: &'a Ranks,
    /// Folder of all runs.
    pub out: &'a Path,
}

/// One way to learn a task.
pub struct Contestant<'a> {
    /// Name in tables; its runs' folders are called after it.
    pub name: String,
    /// The keys that make it another than its neighbours, with their values, for programs.
    pub settings: BTreeMap<String, toml::Value>,
    /// Its choices, but for the seed.
    pub config: Config,
    /// The task with its data under these choices.
    pub task: Box<dyn Task>,
    /// What it begins with, if not from nothing.
    pub start: Option<&'a Checkpoint>,
    /// Steps of the environments within in one step: more than 1 where a policy steers a low level.
    pub body_steps: u64,
}

/// One contestant's training from one seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ComparedRun {
    /// Seed of the training.
    pub seed: u32,
    /// Index of the contestant.
    pub contestant: usize,
}

/// Trainings that failed, and why.
type Failures = BTreeMap<ComparedRun, String>;

/// What came of a training.
pub struct Outcome {
    /// The training.
    pub run: ComparedRun,
    /// What it left, or why it failed.
    pub result: Result<FinishedRun, String>,
}

/// A training at its end.
pub struct FinishedRun {
    /// Its updates; steps are those of the environments within.
    pub rows: Vec<UpdateMetrics>,
    /// How it ended, and what the evaluation episodes found.
    pub summary: KnownSummary,
}

impl Comparison<'_> {
    /// All trainings in their order: seed by seed, so that a first picture of all is there soon.
    pub fn runs(&self) -> Vec<ComparedRun> {
        let contestants = 0..self.contestants.len();
        let of = |seed| {
            contestants
                .clone()
                .map(move |contestant| ComparedRun { seed, contestant })
        };
        (1..=self.seeds).flat_map(of).collect()
    }

    /// Does all trainings in folders of `out`, as many at once as there are observers, each with its share of the
    /// threads. Writes a picture, a table and a JSON by the comparison's title, `evaluation.csv` and `curves.csv`
    /// there. What an earlier call has finished is kept, what it has begun, or ended after fewer steps, is gone on
    /// with. None if it was interrupted.
    ///
    /// Ranks share out the trainings by their numbers; the first then has what came of all, others have only their own.
    /// Trainings of one rank share its process, their data and one signal to stop; what one of them fails of, be it a bug,
    /// is its outcome and leaves the others alone.
    ///
    /// # Errors
    /// See [`Comparison::train_one`]; this rank's trainings under way are saved and stopped.
    pub fn run<O: Observer + Send>(
        &self,
        interrupted: &AtomicBool,
        observers: &mut [O],
    ) -> Result<Option<Vec<Outcome>>> {
        let all = self.runs();
        self.check(&all)?;
        let rank = self.ranks.rank();
        let own = all.iter().copied().skip(rank.number).step_by(rank.of);
        let own: Vec<ComparedRun> = own.collect();
        let mut outcomes = self.do_runs(&own, &Failures::new(), interrupted, observers)?;
        let mut complete = !self.ranks.any(outcomes.len() < own.len());
        let failures = self.failures(&outcomes)?;
        if complete && !self.ranks.is_alone() && self.ranks.is_first() {
            // Those that others have done are at their end.
            outcomes = self.do_runs(&all, &failures, interrupted, observers)?;
            complete = outcomes.len() == all.len();
        }
        Ok(complete.then_some(outcomes))
    }

    /// What the trainings of all ranks failed of.
    fn failures(&self, own: &[Outcome]) -> Result<Failures> {
        let failed = own.iter().filter_map(|outcome| {
            let why = outcome.result.as_ref().err()?;
            Some((outcome.run.seed, outcome.run.contestant, why))
        });
        let own = serde_json::to_vec(&failed.collect::<Vec<_>>())?;
        let mut all = Failures::new();
        for sent in self.ranks.gather(&own) {
            let failed: Vec<(u32, usize, String)> = serde_json::from_slice(&sent)?;
            all.extend(failed.into_iter().map(|(seed, contestant, why)| {
                let run = ComparedRun { seed, contestant };
                (run, why)
            }));
        }
        Ok(all)
    }

    /// Does some trainings, as many at once as there are observers, but for those that have failed elsewhere.
    fn do_runs<O: Observer + Send>(
        &self,
        runs: &[ComparedRun],
        failures: &Failures,
        interrupted: &AtomicBool,
        observers: &mut [O],
    ) -> Result<Vec<Outcome>> {
        let pools = pools(observers.len())?;
        let next = AtomicUsize::new(0);
        std::thread::scope(|scope| {
            let (sender, receiver) = channel();
            for (observer, pool) in observers.iter_mut().zip(&pools) {
                let (next, sender) = (&next, sender.clone());
                let work = move || self.work(runs, failures, next, interrupted, observer, &sender);
                scope.spawn(move || pool.install(work));
            }
            drop(sender);
            let outcomes = self.gather(receiver);
            if outcomes.is_err() {
                interrupted.store(true, Ordering::Relaxed);
            }
            outcomes
        })
    }

    /// Refuses choices that cannot work, and folders that hold other runs.
    fn check(&self, runs: &[ComparedRun]) -> Result<()> {
        for contestant in &self.contestants {
            self.entry.check(&contestant.config)?;
        }
        runs.iter().try_for_each(|&run| self.check_same(run))
    }

    /// Does one training after another, until none is left, nobody waits for more, or it is interrupted.
    fn work(
        &self,
        runs: &[ComparedRun],
        failures: &Failures,
        next: &AtomicUsize,
        interrupted: &AtomicBool,
        observer: &mut (dyn Observer + Send),
        outcomes: &Sender<Result<Outcome>>,
    ) {
        while let Some(&run) = runs.get(next.fetch_add(1, Ordering::Relaxed)) {
            let outcome = match failures.get(&run) {
                Some(why) => Some(Ok(Outcome {
                    run,
                    result: Err(why.clone()),
                })),
                None => self.train_one(run, interrupted, observer).transpose(),
            };
            let Some(outcome) = outcome else { return };
            if outcomes.send(outcome).is_err() {
                return;
            }
        }
    }

    /// Takes what comes of the trainings, and writes it down as often as every contestant can have come once more.
    fn gather(&self, receiver: Receiver<Result<Outcome>>) -> Result<Vec<Outcome>> {
        let mut outcomes = Vec::new();
        for outcome in receiver {
            outcomes.push(outcome?);
            if self.ranks.is_first() && outcomes.len() % self.contestants.len() == 0 {
                outcomes.sort_by_key(|outcome| outcome.run);
                self.write(&outcomes)?;
            }
        }
        Ok(outcomes)
    }

    /// Refuses a folder with runs that are none of these.
    ///
    /// # Errors
    /// It names one of them.
    pub fn refuse_strangers(&self) -> Result<()> {
        let Ok(entries) = std::fs::read_dir(self.out) else {
            return Ok(());
        };
        for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let known = |contestant: &Contestant| contestant.has_run(&name);
            if path.join("config.toml").exists() && !self.contestants.iter().any(known) {
                bail!(
                    "{} holds other runs, like {name}: give another --out, or what those were given",
                    self.out.display()
                );
            }
        }
        Ok(())
    }
}

impl Contestant<'_> {
    /// Its choices for a seed.
    fn config(&self, seed: u32) -> Config {
        let config = self.config.clone();
        Config { seed, ..config }
    }

    /// What its runs' folders begin with.
    fn folder(&self) -> String {
        folder_name(&self.name)
    }

    /// Whether a folder's name is that of one of its runs, whatever the seed.
    fn has_run(&self, folder: &str) -> bool {
        let rest = folder.strip_prefix(&self.folder());
        let seed = rest.and_then(|rest| rest.strip_prefix('-'));
        seed.is_some_and(|seed| seed.parse::<u32>().is_ok())
    }
}

/// A contestant's name without what is awkward in a path.
pub fn folder_name(name: &str) -> String {
    let bare = name.replace(['[', ']', '{', '}', '"'], "");
    let awkward = |letter: char| !letter.is_alphanumeric() && !"._=+-".contains(letter);
    let words = bare.split(awkward).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-")
}

/// Pools that share the threads of this one.
fn pools(count: usize) -> Result<Vec<ThreadPool>> {
    let threads = (rayon::current_num_threads() / count.max(1)).max(1);
    let pool = || Ok(ThreadPoolBuilder::new().num_threads(threads).build()?);
    (0..count).map(|_| pool()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_called_after_contestants() {
        for (name, folder) in [
            ("no-hit-reward", "no-hit-reward"),
            ("gamma=0.9 hidden=[64, 64]", "gamma=0.9-hidden=64-64"),
            ("hit=\"tilt\" lr=-1e-5", "hit=tilt-lr=-1e-5"),
            ("data=../a/b.bvh", "data=..-a-b.bvh"),
        ] {
            assert_eq!(folder_name(name), folder);
        }
    }
}
