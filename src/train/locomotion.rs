//! What the motion-matching tasks share: their data, their choices of the search, their evaluation.

use super::config::{Config, ConfigError, settings, table, within};
use super::controller::{Controller, Scripted};
use super::data;
use super::eval_report::{baseline_json, comparison, motion_quality};
use super::evaluate::{LocomotionReport, evaluate, hardest};
use super::evaluation::{EvalOptions, EvalReport, Evaluation};
use super::planner::plan;
use super::rendered_frames::rendered_frames;
use crate::env::locomotion::{EnvConfig, LEVELS, LocomotionTask};
use crate::env::{EnvBatch, EnvSpec};
use crate::gpu::Device;
use crate::matching::MotionMatcher;
use crate::motion::normalise::Weights;
use crate::nn::Policy;
use crate::playback::quality::compare;
use crate::ranks::Ranks;
use anyhow::Result;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::Write;
use std::sync::Arc;

/// Speeds that the scripted baseline requests, m/s.
const SPEEDS: [f32; 8] = [0.8, 1.2, 1.6, 2.0, 2.5, 3.0, 3.5, 4.0];
/// Episodes whose motion is rated, at most: some hundred thousand frames.
const RATED: usize = 500;

/// A motion-matching task with its motion.
pub struct Locomotion {
    /// The task with its choices.
    pub task: LocomotionTask,
    /// The motion and its index.
    pub matcher: Arc<MotionMatcher>,
}

/// The table `[task]` of a motion-matching task: its own choices, and the weights of the search.
pub fn with_weights(task: &impl Serialize, weights: Weights) -> toml::Table {
    let mut all = table(task);
    all.insert("weights".to_string(), table(&weights).into());
    all
}

/// The task's own choices of a table `[task]`, and the weights of the search.
///
/// # Errors
/// They are not in it, or others are; or a weight is out of range.
pub fn split<T: DeserializeOwned>(config: &Config) -> Result<(T, Weights), ConfigError> {
    let mut own = config.task.settings.clone();
    let weights = match own.remove("weights") {
        Some(toml::Value::Table(weights)) => settings(&weights)?,
        _ => Weights::PAPER,
    };
    check_weights(&weights)?;
    Ok((settings(&own)?, weights))
}

fn check_weights(weights: &Weights) -> Result<(), ConfigError> {
    within(
        "task.weights.foot_position",
        weights.foot_position,
        0.0,
        1e3,
    )?;
    within(
        "task.weights.foot_velocity",
        weights.foot_velocity,
        0.0,
        1e3,
    )?;
    within(
        "task.weights.root_velocity",
        weights.root_velocity,
        0.0,
        1e3,
    )?;
    // Actions are divided by these.
    let (position, direction) = (weights.trajectory_position, weights.trajectory_direction);
    within("task.weights.trajectory_position", position, 1e-3, 1e3)?;
    within("task.weights.trajectory_direction", direction, 1e-3, 1e3)
}

/// The dimensions of a task's environments.
///
/// # Errors
/// A rollout is too long for it.
pub fn rollout_spec(task: LocomotionTask, config: &Config) -> Result<EnvSpec, ConfigError> {
    config.check_rollout(task.max_steps())?;
    let envs = EnvConfig {
        task,
        envs: config.ppo.envs,
        seed: config.seed,
        level: 0,
    };
    Ok(envs.spec())
}

impl Locomotion {
    /// Loads the motion. The notes say what the user should know of it.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn load(
        task: LocomotionTask,
        weights: Weights,
        config: &Config,
    ) -> Result<(Self, Vec<String>)> {
        let (matcher, mut notes) = data::load_matcher(config.data.as_deref(), weights)?;
        if weights != matcher.database.weights {
            let note = "the database was made with other weights than asked for; its own hold";
            notes.push(note.to_string());
        }
        let matcher = Arc::new(matcher);
        Ok((Locomotion { task, matcher }, notes))
    }

    /// Another task with the same motion.
    pub fn with_task(&self, task: LocomotionTask) -> Self {
        let matcher = self.matcher.clone();
        Locomotion { task, matcher }
    }

    /// The motion in a few words.
    pub fn describe(&self) -> String {
        let (minutes, candidates) = (
            self.matcher.database.minutes(),
            self.matcher.database.candidates.len(),
        );
        format!("{minutes:.1} minutes of motion, {candidates} candidates")
    }

    /// Opens the environments of a training.
    ///
    /// # Errors
    /// The device cannot hold them.
    pub fn open(&self, device: &Device, ranks: &Ranks, envs: usize, seed: u32) -> Result<EnvBatch> {
        let config = EnvConfig {
            task: self.task,
            envs,
            seed,
            level: self
                .task
                .curriculum()
                .map_or(LEVELS - 1, |curriculum| curriculum.level()),
        };
        config.open_share(device, ranks, &self.matcher)
    }

    /// Runs the evaluation episodes of the hardest level.
    ///
    /// # Errors
    /// See [`Controller::act`].
    pub fn evaluate(&self, controller: &dyn Controller, episodes: usize) -> Result<Evaluation> {
        Ok(hardest(controller, &self.matcher, self.task, episodes)?.evaluation())
    }

    /// Reports of all levels, the hardest last.
    ///
    /// # Errors
    /// See [`Controller::act`].
    pub fn levels(
        &self,
        controller: &dyn Controller,
        episodes: usize,
    ) -> Result<Vec<LocomotionReport>> {
        let levels = 0..LEVELS;
        levels
            .map(|level| evaluate(controller, &self.matcher, self.task, level, episodes))
            .collect()
    }

    /// Writes what is asked for beside the policy's own report: scripted motion matching, a plan with
    /// full knowledge, the quality of the motion.
    ///
    /// # Errors
    /// See [`Controller::act`].
    pub fn report(
        &self,
        policy: &Policy,
        trained: &LocomotionReport,
        wanted: &EvalOptions,
    ) -> Result<EvalReport> {
        let mut json = serde_json::to_value(trained)?;
        let baseline = match wanted.baseline {
            true => self.baseline(wanted.episodes)?,
            false => Vec::new(),
        };
        let mut text = comparison(trained, &baseline);
        if wanted.baseline {
            json["baseline"] = baseline_json(&baseline)?;
        }
        if wanted.planner > 0 {
            let episodes = wanted.planner.min(wanted.episodes);
            let planned = plan(&self.matcher, self.task, LEVELS - 1, episodes);
            writeln!(
                text,
                "with full knowledge, {:.1} % of {} episodes can be taken to their target",
                100.0 * planned.success,
                planned.episodes
            )?;
            json["planned"] = serde_json::to_value(planned)?;
        }
        if wanted.motion_quality {
            let episodes = wanted.episodes.min(RATED);
            let shown = rendered_frames(policy, &self.matcher, self.task, episodes)?;
            let quality = compare(&self.matcher.database, &shown);
            text += &motion_quality(&quality);
            json["motion"] = serde_json::to_value(quality)?;
        }
        Ok(EvalReport { text, json })
    }

    fn baseline(&self, episodes: usize) -> Result<Vec<(f32, LocomotionReport)>> {
        let database = &self.matcher.database;
        let speeds = SPEEDS.into_iter().map(|speed| {
            let scripted = Scripted { database, speed };
            Ok((
                speed,
                hardest(&scripted, &self.matcher, self.task, episodes)?,
            ))
        });
        speeds.collect()
    }
}
