//! The training loop: act, learn, write down, look whether to stop.

use super::checkpoint::{Checkpoint, Header};
use super::config::Config;
use super::controller::Trained;
use super::evaluate::{Report, hardest};
use super::run_dir::{Folder, Summary};
use super::figures;
use super::progress::Progress;
use super::metrics::{self, Recorder, Row};
use crate::gpu::Device;
use crate::kernels::locomotion::locomotion_layout::state_u32;
use crate::kernels::locomotion::episode_stats;
use crate::motion::database::Database;
use crate::rl::rollout::{self, Rollout};
use crate::rl::ppo::update::{Learner, Losses};
use crate::nn::tensors;
use crate::env::curriculum::Curriculum;
use crate::env::locomotion::live_view::LiveView;
use crate::env::locomotion::{Batch, Setup, EpisodeStats, Task};
use anyhow::{Context, Result, bail};
use burn::tensor::Tensor;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Episodes of an evaluation.
pub const EPISODES: usize = 1000;
/// Fewer, to see whether all of them are worth running.
const GLANCE: usize = 100;
/// A glance this far below the goal may still be chance: two standard errors at 98 %.
const DOUBT: f64 = 0.03;
/// Training success this far below the goal is worth a glance.
const NEAR: f64 = 0.15;
/// What an update reads back.
const NUMBERS: [&str; 13] = [
    "policy loss",
    "value loss",
    "entropy",
    "KL divergence",
    "clip fraction",
    "explained variance",
    "number of episodes",
    "number of successes",
    "number of collisions",
    "number of truncations",
    "number of steps",
    "summed return",
    "sum of the parameters",
];
/// Recent success and return are means over at least so many episodes.
const RECENT: f64 = 500.0;

/// What the trainer remembers from update to update; part of a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Of the latest updates.
    recent: Vec<EpisodeStats>,
    /// Level, recent success and (negative) length of the best policy so far.
    best: Option<(u32, f64, f64)>,
    pub curriculum: Curriculum,
}

impl Memory {
    fn new(task: &Task) -> Self {
        Memory {
            recent: Vec::new(),
            best: None,
            curriculum: Curriculum::on(task.first_level()),
        }
    }

    fn remember(&mut self, tally: EpisodeStats) {
        self.recent.push(tally);
        let episodes = |recent: &[EpisodeStats]| recent.iter().map(|t| t.episodes).sum::<f64>();
        while self.recent.len() > 1 && episodes(&self.recent[1..]) >= RECENT {
            self.recent.remove(0);
        }
    }

    /// Means over the recent episodes: success, steps, return. `None` before the first ended.
    fn means(&self) -> Option<[f64; 3]> {
        let sum = |of: fn(&EpisodeStats) -> f64| self.recent.iter().map(of).sum::<f64>();
        let episodes = sum(|t| t.episodes);
        let sums = [sum(|t| t.successes), sum(|t| t.steps), sum(|t| t.returns)];
        (episodes > 0.0).then(|| sums.map(|sum| sum / episodes))
    }

    /// Whether the recent episodes are the best so far: a higher level, then more success, then
    /// shorter.
    fn improved(&mut self) -> bool {
        let Some([success, length, _]) = self.means() else {
            return false;
        };
        // Whole percents, so that noise in the success does not hide that the walks get shorter.
        let score = (self.curriculum.passed, (success * 100.0).floor(), -length);
        let better = self.best.is_none_or(|best| score > best);
        if better {
            self.best = Some(score);
        }
        better
    }
}

/// For somebody who watches a training from another thread.
#[derive(Default)]
pub struct Watch {
    /// Once the worlds are open; taken by who draws them.
    pub worlds: Mutex<Option<LiveView>>,
    /// The latest update.
    pub row: Mutex<Option<Row>>,
}

impl Watch {
    fn leave<T>(place: &Mutex<Option<T>>, value: T) {
        *place.lock().unwrap_or_else(PoisonError::into_inner) = Some(value);
    }
}

/// A run under way.
struct Run<'a> {
    config: &'a Config,
    folder: &'a Folder,
    database: &'a Arc<Database>,
    device: &'a Device,
    batch: Batch,
    learner: Learner,
    memory: Memory,
    rows: Vec<Row>,
    recorder: Recorder,
    progress: Progress,
    steps: u64,
    /// Seconds before this process, and its start.
    earlier_s: f64,
    start: Instant,
}

/// Trains until a limit, the wished-for success or `interrupted`; with `from`, goes on where that
/// checkpoint was taken; `watch` is kept up to date for who watches. Ends by writing checkpoint, pictures and `summary.json`.
///
/// # Errors
/// A file cannot be written, the device is lost, or the losses are no longer finite. The last
/// good checkpoint and everything before it stay as they are.
pub fn train(
    config: &Config,
    folder: &Folder,
    database: &Arc<Database>,
    device: &Device,
    from: Option<Checkpoint>,
    interrupted: &AtomicBool,
    watch: Option<&Watch>,
) -> Result<Summary> {
    // On a thread of the pool: another would fall asleep and be woken again at every parallel part.
    rayon::scope(|_| {
        let mut run = Run::open(config, folder, database, device, from)?;
        if let Some(watch) = watch {
            Watch::leave(&watch.worlds, run.batch.watch()?);
        }
        let stopped_by = run.advance(interrupted, watch);
        let outcome = stopped_by.and_then(|by| {
            run.save(&folder.checkpoint("last"))?;
            Ok(by)
        });
        run.progress.finish();
        run.conclude(outcome)
    })
}

impl<'a> Run<'a> {
    fn open(
        config: &'a Config,
        folder: &'a Folder,
        database: &'a Arc<Database>,
        device: &'a Device,
        from: Option<Checkpoint>,
    ) -> Result<Self> {
        let ppo = &config.ppo;
        let width = config.task.width();
        let mut memory = Memory::new(&config.task);
        let setup = Setup {
            task: config.task,
            envs: ppo.envs,
            horizon: ppo.horizon,
            seed: config.seed,
            level: memory.curriculum.level(),
        };
        let mut batch = Batch::open(device, database, &setup);
        let (mut steps, mut earlier_s) = (0, 0.0);
        let learner = match from {
            None => Learner::new(ppo, width, device, config.seed)?,
            Some(checkpoint) => {
                let (envs, frames) = (ppo.envs, database.frames());
                let shown = &checkpoint.header.world.state_u32[state_u32::FRAME * envs..][..envs];
                if let Some(frame) = shown.iter().find(|&&frame| frame as usize >= frames) {
                    bail!(
                        "the checkpoint shows frame {frame} of a database of {frames}: it is damaged"
                    );
                }
                batch.restore(&checkpoint.header.world);
                (steps, earlier_s) = (checkpoint.header.steps, checkpoint.header.wall_s);
                memory = checkpoint.header.memory.clone();
                checkpoint.learner(ppo, device)?
            }
        };
        let rows = if steps > 0 {
            metrics::read(&folder.file("metrics.jsonl"), steps)?
        } else {
            Vec::new()
        };
        Ok(Run {
            config,
            folder,
            database,
            device,
            batch,
            learner,
            memory,
            recorder: Recorder::open(folder.path(), &rows)?,
            rows,
            progress: Progress::new(config.steps, config.max_time_s),
            steps,
            earlier_s,
            start: Instant::now(),
        })
    }

    fn wall_s(&self) -> f64 {
        self.earlier_s + self.start.elapsed().as_secs_f64()
    }

    /// Updates until there is a reason to stop.
    fn advance(&mut self, interrupted: &AtomicBool, watch: Option<&Watch>) -> Result<&'static str> {
        loop {
            if self.steps >= self.config.steps {
                return Ok("steps");
            }
            if self
                .config
                .max_time_s
                .is_some_and(|max| self.wall_s() >= max)
            {
                return Ok("time");
            }
            if interrupted.load(Ordering::Relaxed) {
                return Ok("interrupt");
            }
            let before = self.steps;
            let mut row = self.update()?;
            if let Some(watch) = watch {
                Watch::leave(&watch.row, row.clone());
            }
            let reached =
                self.crossed(self.config.evaluate_every, before) && self.arrived(&mut row)?;
            self.write_down(row)?;
            self.keep(before)?;
            if reached {
                return Ok("success");
            }
        }
    }

    /// Whether this update passed a multiple of `every` steps.
    fn crossed(&self, every: u64, before: u64) -> bool {
        before / every != self.steps / every
    }

    fn update(&mut self) -> Result<Row> {
        let ppo = &self.config.ppo;
        let start = Instant::now();
        let policy = self.learner.policy();
        let rollout = rollout::collect(
            &mut self.batch,
            &policy,
            &self.learner.scale,
            ppo,
            self.device,
        )?;
        let losses = self.learner.update(&rollout, ppo);
        // The one read-back of an update. The parameters' sum shows whether the last step broke them.
        let parameters = tensors::sum(self.learner.parameters.clone());
        let numbers = Tensor::cat(vec![losses, self.batch.tally(), parameters], 0);
        let numbers = tensors::read(numbers)?;
        self.steps += ppo.batch() as u64;
        if let Some(place) = numbers.iter().position(|number| !number.is_finite()) {
            bail!(
                "learning diverged: the {} of update {} is {}; checkpoints are from before it, if one was \
                 due. Try a lower ppo.learning_rate",
                NUMBERS[place],
                self.learner.updates,
                numbers[place]
            );
        }
        let losses = Losses::from(&numbers);
        let sums: [f32; episode_stats::SUMS] = std::array::from_fn(|i| numbers[6 + i]);
        let tally = EpisodeStats::from(sums);
        self.memory.remember(tally);
        let row = self.row(losses, tally, &rollout, start.elapsed().as_secs_f64());
        if let Task::Obstacles(task) = &self.config.task
            && self.memory.curriculum.advance(&tally, task, ppo.envs)
        {
            self.batch.set_level(self.memory.curriculum.level());
        }
        self.learner.adapt(losses.kl, self.steps, ppo);
        Ok(row)
    }

    fn row(&self, losses: Losses, tally: EpisodeStats, rollout: &Rollout, total: f64) -> Row {
        let per_episode = |sum: f64| (tally.episodes > 0.0).then(|| sum / tally.episodes);
        let obstacles = matches!(self.config.task, Task::Obstacles(_));
        Row {
            update: self.learner.updates,
            steps: self.steps,
            wall_s: self.wall_s(),
            level: obstacles.then(|| self.memory.curriculum.level()),
            levels_passed: obstacles.then_some(self.memory.curriculum.passed),
            episodes: tally.episodes,
            success: per_episode(tally.successes),
            collision: per_episode(tally.collisions).filter(|_| obstacles),
            truncation: per_episode(tally.truncations),
            episode_return: per_episode(tally.returns),
            episode_length: per_episode(tally.steps),
            policy_loss: losses.policy,
            value_loss: losses.value,
            entropy: losses.entropy,
            kl: losses.kl,
            clip_fraction: losses.clip_fraction,
            explained_variance: losses.explained_variance,
            learning_rate: self.learner.learning_rate,
            steps_per_s: self.config.ppo.batch() as f64 / total,
            simulate_s: rollout.simulate_s,
            act_s: rollout.act_s,
            learn_s: total - rollout.simulate_s - rollout.act_s,
            evaluated_success: None,
            evaluated_time_s: None,
        }
    }

    /// Whether the wished-for success is reached: judged on the fixed evaluation episodes, which
    /// are only run when training looks near it, first a few, then all.
    fn arrived(&self, row: &mut Row) -> Result<bool> {
        let (Some(goal), Some([recent, ..])) = (self.config.stop_success, self.memory.means())
        else {
            return Ok(false);
        };
        if recent < goal - NEAR || self.judge(GLANCE)?.success < goal - DOUBT {
            return Ok(false);
        }
        let report = self.judge(EPISODES)?;
        row.evaluated_success = Some(report.success);
        row.evaluated_time_s = Some(report.time_to_target_mean_s);
        Ok(report.success >= goal)
    }

    fn judge(&self, episodes: usize) -> Result<Report> {
        let parameters = tensors::read(self.learner.parameters.clone())?;
        let policy = Trained::new(&self.learner.shape, &parameters);
        hardest(&policy, self.database, self.config.task, episodes)
    }

    fn write_down(&mut self, row: Row) -> Result<()> {
        self.recorder.write(&row)?;
        let [success, _, episode_return] = self.memory.means().unwrap_or_default();
        self.progress.show(&row, success, episode_return);
        self.rows.push(row);
        Ok(())
    }

    /// Saves what this update has earned: periodic, milestone and best checkpoints.
    fn keep(&mut self, before: u64) -> Result<()> {
        // The best is looked for as often as success is, and before what follows is saved, which
        // remembers it.
        if self.crossed(self.config.evaluate_every, before) && self.memory.improved() {
            self.save(&self.folder.checkpoint("best"))?;
        }
        for steps in figures::crossed(before, self.steps) {
            self.save(&self.folder.checkpoint_at(steps))?;
        }
        if self.crossed(self.config.checkpoint_every, before) {
            let every = self.config.checkpoint_every;
            self.save(&self.folder.checkpoint_at(self.steps / every * every))?;
            self.save(&self.folder.checkpoint("last"))?;
        }
        Ok(())
    }

    fn save(&self, path: &std::path::Path) -> Result<()> {
        let header = Header {
            task: self.config.task,
            observation: self.config.task.width(),
            database: self.database.fingerprint,
            network: self.config.ppo.network.clone(),
            ppo: self.config.ppo.to_toml(),
            seed: self.config.seed,
            steps: self.steps,
            wall_s: self.wall_s(),
            updates: self.learner.updates,
            rates: [self.learner.learning_rate, self.learner.kl_coefficient],
            adam_steps: self.learner.adam.steps,
            scale_updates: self.learner.scale.updates,
            world: self.batch.snapshot()?,
            memory: self.memory.clone(),
        };
        Ok(Checkpoint::take(header, &self.learner)?.save(path)?)
    }

    /// Final evaluation, summary and pictures. After a failure only the summary is written.
    fn conclude(self, outcome: Result<&'static str>) -> Result<Summary> {
        let wall_s = self.wall_s();
        let obstacles = matches!(self.config.task, Task::Obstacles(_));
        let mut summary = Summary {
            steps: self.steps,
            wall_s,
            steps_per_s: self.steps as f64 / wall_s.max(1e-9),
            success: 0.0,
            time_to_target_mean_s: 0.0,
            level: obstacles.then(|| self.memory.curriculum.level()),
            levels_passed: obstacles.then_some(self.memory.curriculum.passed),
            device: self.device.name(),
            seed: self.config.seed,
            stopped_by: "failure",
        };
        match outcome {
            Ok(by) => {
                let report = self.judge(EPISODES)?;
                summary.stopped_by = by;
                summary.success = report.success;
                summary.time_to_target_mean_s = report.time_to_target_mean_s;
                self.folder.write_summary(&summary)?;
                figures::draw(self.folder, &self.rows, self.database, self.config.task)?;
                Ok(summary)
            }
            Err(error) => {
                self.folder
                    .write_summary(&summary)
                    .context(format!("{error:#}; then"))?;
                Err(error)
            }
        }
    }
}
