//! The training loop: play and learn, write down, look whether to stop. It knows no task.

use super::checkpoint::{Checkpoint, Header};
use super::config::{Config, VERSION};
use super::evaluation::Evaluation;
use super::metrics::{self, UpdateMetrics};
use super::metrics_writer::MetricsWriter;
use super::observer::Observer;
use super::run_dir::{RunDir, Summary};
#[cfg(feature = "report")]
use super::snapshots::{Snapshot, SnapshotMaker};
use super::state::TrainerState;
use super::task::Task;
use crate::env::humanoid::batch::overflow_warning;
use crate::env::{EnvBatch, EnvSpec};
use crate::gpu::Device;
use crate::ranks::Ranks;
use crate::rl::Algorithm;
use anyhow::{Context, Result};
use std::collections::BTreeSet;
use std::path::Path;
#[cfg(feature = "report")]
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Episodes of an evaluation.
pub const EPISODES: usize = 1000;
/// Fewer, to see whether all of them are worth running.
const GLANCE: usize = 100;
/// A glance this far below the goal may still be chance: two standard errors at 98 %.
const DOUBT: f64 = 0.03;
/// A run that is killed loses at most so much.
const SAVE_EVERY: Duration = Duration::from_secs(30);
/// Training success this far below the goal is worth a glance.
const NEAR: f64 = 0.15;

/// What a training is of.
#[derive(Clone, Copy)]
pub struct Training<'a> {
    /// The choices.
    pub config: &'a Config,
    /// The task with its data.
    pub task: &'a dyn Task,
    /// The run's folder.
    pub run: &'a RunDir,
    /// Where to train.
    pub device: &'a Device,
    /// Who else trains. All begin with the same choices, data and checkpoints; the first writes the run's folder.
    pub ranks: &'a Ranks,
    /// What a new run begins with, if not from nothing: a checkpoint of another.
    pub start: Option<&'a Checkpoint>,
}

/// Trains until a limit, the wanted success or `interrupted`; with `from`, goes on where that checkpoint
/// of the run was taken. Ends by writing a checkpoint, figures and `summary.json`; the summary that ranks but the first
/// return has no evaluation.
///
/// # Errors
/// The networks or the checkpoint do not fit, and nothing was written; or a file cannot be written, the
/// device is lost, or the losses are no longer finite. The last good checkpoint and everything before it
/// stay as they are.
pub fn train(
    training: Training,
    from: Option<Checkpoint>,
    interrupted: &AtomicBool,
    observer: &mut (dyn Observer + Send),
) -> Result<Summary> {
    // On a thread of the pool: another would fall asleep and be woken again at every parallel part.
    rayon::scope(|_| {
        let opened = Loop::open(training, from, observer);
        let mut state = opened.inspect_err(|_| {
            if training.ranks.is_first() {
                training.run.discard();
            }
        })?;
        observer.opened(&mut state.envs)?;
        let stopped_by = state.advance(interrupted, observer);
        let outcome = stopped_by.and_then(|by| {
            state.save_last()?;
            let mut overflow = [state.envs.contact_overflow()? as f32];
            training.ranks.sum(&mut overflow);
            if let Some(warning) = overflow_warning(overflow[0] as u64) {
                observer.noted(&warning);
            }
            Ok(by)
        });
        state.conclude(outcome)
    })
}

/// The updates of a run up to a number of steps.
fn known_rows(run: &RunDir, steps: u64, observer: &mut dyn Observer) -> Result<Vec<UpdateMetrics>> {
    let path = run.metrics_path();
    let known = metrics::read(&path, steps)?;
    for line in known.damaged {
        observer.noted(&format!(
            "note: {}, line {line}, was no update: left out",
            path.display()
        ));
    }
    Ok(known.rows)
}

/// A training under way.
struct Loop<'a> {
    training: Training<'a>,
    envs: EnvBatch,
    learner: Box<dyn Algorithm>,
    state: TrainerState,
    rows: Vec<UpdateMetrics>,
    /// Writes the metrics, on the first rank.
    writer: Option<MetricsWriter>,
    /// Makes the pictures, on the first rank, until one cannot be made.
    #[cfg(feature = "report")]
    snapshots: Option<SnapshotMaker<'a>>,
    /// Environment steps so far.
    steps: u64,
    /// Seconds before this process, and its start.
    earlier_s: f64,
    start: Instant,
    /// Seconds of communication before that.
    talked_s: f64,
    /// When `last` was written.
    saved: Instant,
}

impl<'a> Loop<'a> {
    fn open(
        training: Training<'a>,
        from: Option<Checkpoint>,
        observer: &mut dyn Observer,
    ) -> Result<Self> {
        let Training {
            config,
            task,
            run,
            device,
            ranks,
            start,
        } = training;
        let opened = || -> Result<_> {
            let envs = task.open(device, ranks, config.ppo.envs, config.seed)?;
            let learner = task.learner(config, &envs, device)?;
            Ok((envs, learner))
        };
        // Nothing is written before all ranks could begin.
        let (mut envs, mut learner) = ranks.all_or_none(opened())?;
        let (mut steps, mut earlier_s, mut state) = (0, 0.0, TrainerState::default());
        let mut rows = Vec::new();
        let fresh = from.is_none();
        if let (Some(start), true) = (start, fresh) {
            start.start(&mut *learner)?;
        }
        if let Some(checkpoint) = from {
            steps = checkpoint.header.steps;
            let restored = checkpoint.restore(&mut *learner, &mut envs)?;
            state = restored.state;
            if !restored.envs {
                observer.noted(
                    "note: the environments were shared out otherwise: all of them begin new episodes",
                );
            }
            if ranks.is_first() {
                rows = known_rows(run, steps, observer)?;
            }
            earlier_s = rows.last().map_or(0.0, |row| row.wall_s);
        }
        let writer = ranks
            .is_first()
            .then(|| MetricsWriter::open(run, &rows))
            .transpose()?;
        let mut opened = Loop {
            training,
            envs,
            learner,
            state,
            writer,
            #[cfg(feature = "report")]
            snapshots: ranks
                .is_first()
                .then(|| SnapshotMaker::new(run, task, config.film_share)),
            rows,
            steps,
            earlier_s,
            start: Instant::now(),
            talked_s: ranks.seconds(),
            saved: Instant::now(),
        };
        // From here on a run that is killed can go on: there is no run without a checkpoint.
        if fresh {
            opened.save_last()?;
        }
        if ranks.is_first() {
            run.write_config(config)?;
        }
        Ok(opened)
    }

    fn wall_s(&self) -> f64 {
        self.earlier_s + self.start.elapsed().as_secs_f64()
    }

    /// Updates until there is a reason to stop.
    fn advance(
        &mut self,
        interrupted: &AtomicBool,
        observer: &mut dyn Observer,
    ) -> Result<&'static str> {
        let Training { config, ranks, .. } = self.training;
        loop {
            if self.steps >= config.steps {
                return Ok("steps");
            }
            // As whoever resumes the run will see it.
            let wall_s = self.rows.last().map_or(0.0, |row| row.wall_s);
            if self.first_says(config.max_time_s.is_some_and(|max| wall_s >= max)) {
                return Ok("time");
            }
            if ranks.any(interrupted.load(Ordering::Relaxed)) {
                return Ok("interrupt");
            }
            let before = self.steps;
            let mut row = self.update()?;
            observer.updated(&row, self.state.means().unwrap_or_default());
            let reached =
                self.crossed(config.evaluate_every, before) && self.succeeded(&mut row)?;
            if let Some(writer) = &mut self.writer {
                writer.write(&row)?;
                if let Some(note) = writer.take_note() {
                    observer.noted(&note);
                }
            }
            self.rows.push(row);
            self.keep(before, observer)?;
            if reached {
                return Ok("success");
            }
        }
    }

    /// What the first rank says, where others may see it otherwise: clocks differ.
    fn first_says(&self, own: bool) -> bool {
        let ranks = self.training.ranks;
        ranks.any(own && ranks.is_first())
    }

    /// Whether this update passed a multiple of `every` steps.
    fn crossed(&self, every: u64, before: u64) -> bool {
        before / every != self.steps / every
    }

    fn update(&mut self) -> Result<UpdateMetrics> {
        let (start, batch) = (Instant::now(), self.training.config.batch());
        let ranks = self.training.ranks;
        let talked = ranks.seconds();
        let iteration = self.learner.iterate(&mut self.envs, self.steps)?;
        self.steps += batch;
        self.state.remember(&iteration.stats);
        let row = UpdateMetrics {
            update: self.steps / batch,
            steps: self.steps,
            wall_s: self.wall_s(),
            level: self.level(),
            levels_passed: self.levels_passed(),
            steps_per_s: batch as f64 / start.elapsed().as_secs_f64(),
            communication_s: (!ranks.is_alone()).then(|| ranks.seconds() - talked),
            ..UpdateMetrics::new(&iteration)
        };
        self.envs.advance_curriculum(&iteration.stats);
        Ok(row)
    }

    fn level(&self) -> Option<u32> {
        self.envs
            .curriculum
            .as_ref()
            .map(|curriculum| curriculum.level())
    }

    fn levels_passed(&self) -> Option<u32> {
        self.envs
            .curriculum
            .as_ref()
            .map(|curriculum| curriculum.passed)
    }

    /// Whether the wanted success is reached: on the fixed evaluation episodes, which are only run when
    /// training looks near it, first a few, then all.
    fn succeeded(&self, row: &mut UpdateMetrics) -> Result<bool> {
        let (Some(goal), Some(recent)) = (self.training.config.stop_at_success, self.state.means())
        else {
            return Ok(false);
        };
        if recent.success < goal - NEAR {
            return Ok(false);
        }
        let ranks = self.training.ranks;
        let reached = ranks.is_first() && self.judged(goal, row)?;
        Ok(ranks.any(reached))
    }

    /// Whether the policy reaches a success.
    fn judged(&self, goal: f64, row: &mut UpdateMetrics) -> Result<bool> {
        if self.evaluate(GLANCE)?.success < goal - DOUBT {
            return Ok(false);
        }
        let found = self.evaluate(EPISODES)?;
        row.evaluated(&found);
        Ok(found.success >= goal)
    }

    fn evaluate(&self, episodes: usize) -> Result<Evaluation> {
        self.training
            .task
            .evaluate(&self.learner.policy()?, episodes)
    }

    /// Saves what this update has earned: periodic, milestone and best checkpoints.
    fn keep(&mut self, before: u64, observer: &mut dyn Observer) -> Result<()> {
        let Training {
            config, task, run, ..
        } = self.training;
        // The best is looked for as often as success is, and before what follows is saved, which
        // remembers it.
        if self.crossed(config.evaluate_every, before)
            && self.state.improved(self.levels_passed().unwrap_or(0))
        {
            self.save(&run.checkpoint("best"))?;
        }
        let passed = |steps: &u64| before < *steps && *steps <= self.steps;
        let every = config.checkpoint_every;
        let periodic = self.crossed(every, before);
        let periodic = periodic.then(|| self.steps / every * every);
        let milestones = task.milestones().iter().copied().filter(passed);
        let kept: BTreeSet<u64> = milestones.chain(periodic).collect();
        for &steps in &kept {
            self.save(&run.checkpoint_at(steps))?;
        }
        let due = self.first_says(self.saved.elapsed() >= SAVE_EVERY);
        if due || !kept.is_empty() || before == 0 {
            self.save_last()?;
        }
        kept.last()
            .map_or(Ok(()), |&steps| self.show(steps, observer))
    }

    /// Makes pictures of what the policy does after so many steps.
    #[cfg(feature = "report")]
    fn show(&mut self, steps: u64, observer: &mut dyn Observer) -> Result<()> {
        let Some(snapshots) = &mut self.snapshots else {
            return Ok(());
        };
        match snapshots.take(&self.learner.policy()?, steps, observer) {
            Ok(made) => self.writer.iter_mut().for_each(|writer| writer.add(&made)),
            Err(error) => {
                observer.noted(&format!(
                    "note: {error:#}; the training goes on without pictures"
                ));
                self.snapshots = None;
            }
        }
        Ok(())
    }

    #[cfg(not(feature = "report"))]
    fn show(&mut self, _steps: u64, _observer: &mut dyn Observer) -> Result<()> {
        Ok(())
    }

    /// Saves where a run that is stopped goes on.
    fn save_last(&mut self) -> Result<()> {
        self.saved = Instant::now();
        self.save(&self.training.run.checkpoint("last"))
    }

    /// Lets the first rank write a checkpoint of all.
    fn save(&self, path: &Path) -> Result<()> {
        let Training {
            config,
            task,
            ranks,
            ..
        } = self.training;
        let header = Header {
            version: VERSION.to_string(),
            task: config.task.name.clone(),
            spec: EnvSpec {
                envs: config.ppo.envs,
                ..self.envs.spec()
            },
            fingerprint: task.fingerprint(),
            config: config.to_toml(),
            steps: self.steps,
        };
        let checkpoint = Checkpoint::take(header, &*self.learner, &self.envs, &self.state)?;
        if ranks.is_first() {
            checkpoint.save(path)?;
        }
        Ok(())
    }

    /// Final evaluation, summary and figures. After a failure only the summary is written.
    fn conclude(self, outcome: Result<&'static str>) -> Result<Summary> {
        let Training {
            config,
            run,
            device,
            ranks,
            ..
        } = self.training;
        let wall_s = self.wall_s();
        let mut summary = Summary {
            version: VERSION,
            steps: self.steps,
            wall_s,
            steps_per_s: self.steps as f64 / wall_s.max(1e-9),
            evaluation: Evaluation::default(),
            level: self.level(),
            levels_passed: self.levels_passed(),
            device: device.name(),
            seed: config.seed,
            ranks: ranks.count(),
            communication_share: (ranks.seconds() - self.talked_s)
                / self.start.elapsed().as_secs_f64().max(1e-9),
            parameters_hash: self.learner.policy().map_or(0, |policy| policy.hash()),
            stopped_by: "failure",
        };
        match outcome {
            Ok(by) if !ranks.is_first() => {
                summary.stopped_by = by;
                Ok(summary)
            }
            Ok(by) => {
                summary.stopped_by = by;
                summary.evaluation = self.evaluate(EPISODES)?;
                run.write_summary(&summary)?;
                #[cfg(feature = "report")]
                self.figures()?;
                Ok(summary)
            }
            Err(error) => {
                if ranks.is_first() {
                    run.write_summary(&summary)
                        .context(format!("{error:#}; then"))?;
                }
                Err(error)
            }
        }
    }

    /// Draws the figures of the run, and adds them to what TensorBoard shows.
    #[cfg(feature = "report")]
    fn figures(mut self) -> Result<()> {
        let Training { task, run, .. } = self.training;
        let figure = |path: PathBuf| Snapshot {
            tag: format!(
                "figures/{}",
                path.file_stem().unwrap_or_default().to_string_lossy()
            ),
            steps: self.steps,
            path,
        };
        let files = task.figures(run, &self.rows)?.into_iter();
        let pictures: Vec<Snapshot> = files.map(figure).collect();
        self.writer
            .iter_mut()
            .for_each(|writer| writer.add(&pictures));
        Ok(())
    }
}
