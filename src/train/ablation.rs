//! Variants of a task side by side, trained from several seeds each and evaluated on the same episodes.

use super::checkpoint::Checkpoint;
use super::config::Config;
use super::evaluation::Evaluation;
use super::metrics::{self, UpdateMetrics};
use super::observer::Observer;
use super::run_dir::RunDir;
use super::task::{Ablation, Task, TaskEntry, Variant};
use super::tasks::config_of;
use super::trainer::{EPISODES, Training, train};
use crate::container::write_whole;
use crate::env::EnvSpec;
use crate::gpu::Device;
use crate::report::table::table;
use anyhow::{Result, bail};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs of an ablation: the task, what to compare, and the choices that all variants share.
pub struct Comparison<'a> {
    /// The task.
    pub entry: &'a TaskEntry,
    /// Its variants.
    pub ablation: &'a Ablation,
    /// The choices that all variants share.
    pub base: &'a Config,
    /// The task with its data under those choices.
    pub task: &'a dyn Task,
    /// Where the variants are trained.
    pub device: &'a Device,
    /// Folder of all runs.
    pub out: &'a Path,
    /// What all variants begin with, if not from nothing.
    pub start: Option<&'a Checkpoint>,
}

/// One variant's training from one seed.
pub struct Outcome {
    /// Name of the variant.
    pub variant: &'static str,
    /// Seed of the training.
    pub seed: u32,
    /// Its updates.
    pub rows: Vec<UpdateMetrics>,
    /// What the evaluation episodes found at its end.
    pub evaluation: Evaluation,
}

impl Comparison<'_> {
    /// Trains all variants from the seeds 1 to `seeds` in folders of `out`, and writes `ablation.png`,
    /// `ablation.txt`, `evaluation.csv` and `curves.csv` there. What an earlier call has finished is kept,
    /// what it has begun, or ended after fewer steps, is gone on with. None if it was interrupted.
    ///
    /// # Errors
    /// See [`train`]; or `out` holds runs of another configuration.
    pub fn run(
        &self,
        seeds: u32,
        interrupted: &AtomicBool,
        observer: &mut (dyn Observer + Send),
    ) -> Result<Option<Vec<Outcome>>> {
        let variants = self.ablation.variants;
        for variant in variants {
            self.entry.check(&self.configure(variant, 1))?;
        }
        let mut outcomes = Vec::new();
        // Seed by seed, so that a first picture of all variants is there soon.
        for seed in 1..=seeds {
            for variant in variants {
                let path = self.out.join(format!("{}-{seed}", variant.name));
                let all = variants.len() * seeds as usize;
                observer.noted(&format!("{} of {all}", path.display()));
                match self.outcome(variant, seed, &path, interrupted, observer)? {
                    Some(outcome) => outcomes.push(outcome),
                    None => return Ok(None),
                }
            }
            self.write(&outcomes)?;
        }
        Ok(Some(outcomes))
    }

    /// The choices of a variant.
    fn configure(&self, variant: &Variant, seed: u32) -> Config {
        let mut config = self.base.clone();
        config.seed = seed;
        config.task.settings.extend((variant.changes)());
        config
    }

    /// Trains a variant to its end, from wherever it is, and evaluates it. None if it was interrupted.
    fn outcome(
        &self,
        variant: &Variant,
        seed: u32,
        path: &Path,
        interrupted: &AtomicBool,
        observer: &mut (dyn Observer + Send),
    ) -> Result<Option<Outcome>> {
        let config = self.configure(variant, seed);
        let spec = self.entry.check(&config)?;
        let task = self.task.with_choices(&config)?;
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
                task: &*task,
                run: &run,
                device: self.device,
                start: self.start,
            };
            train(training, from, interrupted, observer)?;
        }
        if interrupted.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let policy = Checkpoint::load(&run.last()?)?.policy;
        Ok(Some(Outcome {
            variant: variant.name,
            seed,
            rows: metrics::read(&run.metrics_path(), config.steps + config.batch())?.rows,
            evaluation: task.evaluate(&policy, EPISODES)?,
        }))
    }

    /// The last checkpoint of a run that was begun by an earlier call, if it has one.
    fn begun(
        &self,
        config: &Config,
        run: &RunDir,
        spec: &EnvSpec,
        fingerprint: u32,
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
            ("ablation.txt", self.summary(outcomes)),
            ("evaluation.csv", self.evaluations(outcomes)),
            ("curves.csv", self.curves(outcomes)),
        ] {
            write_whole(&self.out.join(name), text.as_bytes())?;
        }
        Ok(())
    }

    #[cfg(feature = "report")]
    fn draw(&self, outcomes: &[Outcome]) -> Result<()> {
        use super::figures::points;
        use crate::report::ablation::{Method, draw};
        let of = |name: &'static str| outcomes.iter().filter(move |o| o.variant == name);
        let methods = self.ablation.variants.iter().enumerate();
        let methods = methods.map(|(colour, variant)| Method {
            name: variant.name.to_string(),
            colour,
            seeds: of(variant.name)
                .map(|outcome| points(&outcome.rows))
                .collect(),
        });
        Ok(draw(
            &self.out.join("ablation.png"),
            &methods.collect::<Vec<_>>(),
        )?)
    }

    /// A table of the variants: means over the seeds.
    pub fn summary(&self, outcomes: &[Outcome]) -> String {
        let measures = self.ablation.measures;
        let mut titles = vec!["variant", "seeds", "success %", "of each seed"];
        titles.extend(measures.iter().map(|measure| measure.title));
        let row = |variant: &Variant| {
            let found = outcomes
                .iter()
                .filter(|outcome| outcome.variant == variant.name);
            let found: Vec<&Evaluation> = found.map(|outcome| &outcome.evaluation).collect();
            let mean = |of: &dyn Fn(&Evaluation) -> f64| {
                found.iter().map(|one| of(one)).sum::<f64>() / found.len().max(1) as f64
            };
            let each = found
                .iter()
                .map(|one| format!("{:.1}", 100.0 * one.success));
            let mut row = vec![
                variant.name.to_string(),
                found.len().to_string(),
                format!("{:.1}", 100.0 * mean(&|one| one.success)),
                each.collect::<Vec<_>>().join(" "),
            ];
            row.extend(measures.iter().map(|measure| {
                let value = measure.unit * mean(&|one| one.measure(measure.name));
                format!("{value:.*}", measure.digits)
            }));
            row
        };
        let rows: Vec<_> = self.ablation.variants.iter().map(row).collect();
        table(&titles, &rows)
    }

    /// The evaluations as CSV.
    fn evaluations(&self, outcomes: &[Outcome]) -> String {
        let names = self.ablation.measures.iter().map(|measure| measure.name);
        let mut text = csv(["variant", "seed", "episodes", "success"]
            .into_iter()
            .chain(names.clone()));
        for outcome in outcomes {
            let found = &outcome.evaluation;
            let first = [
                outcome.variant.to_string(),
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
        let rates = self.ablation.rates;
        let first = [
            "variant", "seed", "steps", "wall_s", "level", "episodes", "success",
        ];
        let titles = first.iter().chain(rates).chain(&["return", "length"]);
        let mut text = csv(titles.copied());
        let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        for outcome in outcomes {
            for row in &outcome.rows {
                let mut line = vec![
                    outcome.variant.to_string(),
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
