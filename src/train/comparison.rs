//! Ways to learn a task side by side, trained from several seeds each and evaluated on the same episodes.

use super::checkpoint::Checkpoint;
use super::config::Config;
use super::evaluation::Evaluation;
use super::fingerprint::Fingerprint;
use super::metrics::{self, UpdateMetrics};
use super::observer::Observer;
use super::run_dir::RunDir;
use super::task::{Measure, Task, TaskEntry};
use super::tasks::config_of;
use super::trainer::{EPISODES, Training, train};
use crate::container::write_whole;
use crate::env::EnvSpec;
use crate::gpu::Device;
use crate::ranks::Ranks;
use crate::report::table::table;
use anyhow::{Result, bail};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Trainings side by side.
pub struct Comparison<'a> {
    /// What the files with the figures are called.
    pub title: &'static str,
    /// The task that all learn.
    pub entry: &'a TaskEntry,
    /// Who is compared; the first is what the others are compared with.
    pub contestants: Vec<Contestant<'a>>,
    /// What is compared besides the success.
    pub measures: &'static [Measure],
    /// Rates of episodes in `metrics.jsonl` whose curves are kept.
    pub rates: &'static [&'static str],
    /// The device that all are trained on.
    pub device: &'a Device,
    /// Folder of all runs.
    pub out: &'a Path,
}

/// One way to learn a task.
pub struct Contestant<'a> {
    /// Name of its runs' folders, and in tables.
    pub name: &'static str,
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
pub struct Outcome {
    /// Name of the contestant.
    pub contestant: &'static str,
    /// Seed of the training.
    pub seed: u32,
    /// Its updates; steps are those of the environments within.
    pub rows: Vec<UpdateMetrics>,
    /// What the evaluation episodes found at its end.
    pub evaluation: Evaluation,
}

impl Comparison<'_> {
    /// Trains all contestants from the seeds 1 to `seeds` in folders of `out`, and writes a picture and a table
    /// by the comparison's title, `evaluation.csv` and `curves.csv` there. What an earlier call has finished is
    /// kept, what it has begun, or ended after fewer steps, is gone on with. None if it was interrupted.
    ///
    /// # Errors
    /// See [`train`]; or `out` holds runs of another configuration.
    pub fn run(
        &self,
        seeds: u32,
        interrupted: &AtomicBool,
        observer: &mut (dyn Observer + Send),
    ) -> Result<Option<Vec<Outcome>>> {
        for contestant in &self.contestants {
            self.entry.check(&contestant.config)?;
        }
        let mut outcomes = Vec::new();
        // Seed by seed, so that a first picture of all is there soon.
        for seed in 1..=seeds {
            for contestant in &self.contestants {
                let path = self.out.join(format!("{}-{seed}", contestant.name));
                let all = self.contestants.len() * seeds as usize;
                observer.noted(&format!("{} of {all}", path.display()));
                match self.outcome(contestant, seed, &path, interrupted, observer)? {
                    Some(outcome) => outcomes.push(outcome),
                    None => return Ok(None),
                }
            }
            self.write(&outcomes)?;
        }
        Ok(Some(outcomes))
    }

    /// Trains a contestant to its end, from wherever it is, and evaluates it. None if it was interrupted.
    fn outcome(
        &self,
        contestant: &Contestant,
        seed: u32,
        path: &Path,
        interrupted: &AtomicBool,
        observer: &mut (dyn Observer + Send),
    ) -> Result<Option<Outcome>> {
        let config = Config {
            seed,
            ..contestant.config.clone()
        };
        let task = &*contestant.task;
        let spec = self.entry.check(&config)?;
        let begun = path.join("config.toml").exists();
        let run = match begun {
            true => RunDir::open(path)?.claimed()?,
            false => RunDir::create(Some(path), self.entry.name)?,
        };
        let from = match begun {
            true => self.begun(&config, &run, &spec, task.fingerprint())?,
            false => None,
        };
        let done = from.as_ref().map_or(0, |found| found.header.steps);
        if done < config.steps {
            let training = Training {
                config: &config,
                task,
                run: &run,
                device: self.device,
                ranks: &Ranks::alone(),
                start: contestant.start,
            };
            observer.begins(&config);
            train(training, from, interrupted, observer)?;
        }
        if interrupted.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let policy = Checkpoint::load(&run.last()?)?.policy;
        let mut rows = metrics::read(&run.metrics_path(), config.steps + config.batch())?.rows;
        let each = contestant.body_steps;
        rows.iter_mut().for_each(|row| row.steps *= each);
        Ok(Some(Outcome {
            contestant: contestant.name,
            seed,
            rows,
            evaluation: task.evaluate(&policy, EPISODES)?,
        }))
    }

    /// The last checkpoint of a run that was begun by an earlier call, if it has one.
    fn begun(
        &self,
        config: &Config,
        run: &RunDir,
        spec: &EnvSpec,
        fingerprint: Fingerprint,
    ) -> Result<Option<Checkpoint>> {
        let found = Config {
            steps: config.steps,
            ..config_of(run)?
        };
        let path = run.path().display();
        if found != *config {
            bail!(
                "{path} holds a run of another configuration: give another --out, or what that one was given"
            );
        }
        if !run.checkpoint("last").exists() {
            return Ok(None);
        }
        let checkpoint = Checkpoint::load_for(&run.last()?, self.entry.name, spec, fingerprint)?;
        let done = checkpoint.header.steps;
        if done >= config.steps + config.batch() {
            bail!(
                "{path} has done {done} steps, more than are asked for: give --steps {done}, or another --out"
            );
        }
        Ok(Some(checkpoint))
    }

    fn write(&self, outcomes: &[Outcome]) -> Result<()> {
        #[cfg(feature = "report")]
        self.draw(outcomes)?;
        for (name, text) in [
            (format!("{}.txt", self.title), self.summary(outcomes)),
            ("evaluation.csv".into(), self.evaluations(outcomes)),
            ("curves.csv".into(), self.curves(outcomes)),
        ] {
            write_whole(&self.out.join(name), text.as_bytes())?;
        }
        Ok(())
    }

    #[cfg(feature = "report")]
    fn draw(&self, outcomes: &[Outcome]) -> Result<()> {
        use super::figures::points;
        use crate::report::ablation::{Method, draw};
        let of = |name: &'static str| outcomes.iter().filter(move |o| o.contestant == name);
        let methods = self.contestants.iter().enumerate();
        let methods = methods.map(|(colour, contestant)| Method {
            name: contestant.name.to_string(),
            colour,
            seeds: of(contestant.name)
                .map(|outcome| points(&outcome.rows))
                .collect(),
        });
        Ok(draw(
            &self.out.join(format!("{}.png", self.title)),
            &methods.collect::<Vec<_>>(),
        )?)
    }

    /// A table of all: means over the seeds.
    pub fn summary(&self, outcomes: &[Outcome]) -> String {
        let measures = self.measures;
        let mut titles = vec!["variant", "seeds", "success %", "of each seed"];
        titles.extend(measures.iter().map(|measure| measure.title));
        let row = |contestant: &Contestant| {
            let found = outcomes
                .iter()
                .filter(|outcome| outcome.contestant == contestant.name);
            let found: Vec<&Evaluation> = found.map(|outcome| &outcome.evaluation).collect();
            let mean = |of: &dyn Fn(&Evaluation) -> f64| {
                found.iter().map(|one| of(one)).sum::<f64>() / found.len().max(1) as f64
            };
            let each = found
                .iter()
                .map(|one| format!("{:.1}", 100.0 * one.success));
            let mut row = vec![
                contestant.name.to_string(),
                found.len().to_string(),
                format!("{:.1}", 100.0 * mean(&|one| one.success)),
                each.collect::<Vec<_>>().join(" "),
            ];
            row.extend(measures.iter().map(|measure| {
                // Not -0.
                let value = measure.unit * mean(&|one| one.measure(measure.name)) + 0.0;
                format!("{value:.*}", measure.digits)
            }));
            row
        };
        let rows: Vec<_> = self.contestants.iter().map(row).collect();
        table(&titles, &rows)
    }

    /// The evaluations as CSV.
    fn evaluations(&self, outcomes: &[Outcome]) -> String {
        let names = self.measures.iter().map(|measure| measure.name);
        let mut text = csv(["variant", "seed", "episodes", "success"]
            .into_iter()
            .chain(names.clone()));
        for outcome in outcomes {
            let found = &outcome.evaluation;
            let first = [
                outcome.contestant.to_string(),
                outcome.seed.to_string(),
                found.episodes.to_string(),
                found.success.to_string(),
            ];
            let measures = names.clone().map(|name| found.measure(name).to_string());
            text += &csv(first.into_iter().chain(measures));
        }
        text
    }

    /// The updates as CSV.
    fn curves(&self, outcomes: &[Outcome]) -> String {
        let rates = self.rates;
        let first = [
            "variant", "seed", "steps", "wall_s", "level", "episodes", "success",
        ];
        let titles = first.iter().chain(rates).chain(&["return", "length"]);
        let mut text = csv(titles.copied());
        let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        for outcome in outcomes {
            for row in &outcome.rows {
                let mut line = vec![
                    outcome.contestant.to_string(),
                    outcome.seed.to_string(),
                    row.steps.to_string(),
                    row.wall_s.to_string(),
                    row.level.map_or(String::new(), |level| level.to_string()),
                    row.episodes.to_string(),
                    number(row.success),
                ];
                line.extend(rates.iter().map(|name| number(row.rate(name))));
                line.extend([number(row.episode_return), number(row.episode_length)]);
                text += &csv(line.into_iter());
            }
        }
        text
    }
}

/// A line of comma-separated values.
fn csv<T: AsRef<str>>(values: impl Iterator<Item = T>) -> String {
    let mut line = String::new();
    for value in values {
        if !line.is_empty() {
            line.push(',');
        }
        line += value.as_ref();
    }
    line.push('\n');
    line
}
