//! What the trainer and the command line know of a task.
//!
//! [`TaskEntry`] is a task by name: its presets, the check of its choices, and how its data is loaded;
//! all of them are in [`super::tasks::REGISTRY`]. A [`Task`] is one with its choices made and its data
//! loaded.

use super::body_episodes::BodyEpisodes;
use super::config::{Base, Config, ConfigError, Preset, TaskPreset};
use super::evaluation::{EvalOptions, EvalReport, Evaluation};
#[cfg(feature = "report")]
use super::figures::draw_curve;
use super::fingerprint::Fingerprint;
use super::locomotion::Locomotion;
#[cfg(feature = "report")]
use super::metrics::UpdateMetrics;
#[cfg(feature = "report")]
use super::run_dir::RunDir;
use super::tournament::Bouts;
use crate::env::humanoid::driver::BodyDriver;
use crate::env::{EnvBatch, EnvSpec};
use crate::gpu::Device;
use crate::nn::{ActorCritic, Policy};
use crate::physics::motion_library::MotionLibrary;
use crate::ranks::Ranks;
use crate::rl::Algorithm;
use crate::rl::amp::discriminator::network;
use crate::rl::ase::FrozenLowLevel;
use crate::rl::ppo::PpoLearner;
use anyhow::Result;
use std::path::Path;
#[cfg(feature = "report")]
use std::path::PathBuf;

/// A task by name, before its choices are made.
pub struct TaskEntry {
    /// On the command line, in the configuration, and of its run folders.
    pub name: &'static str,
    /// A line for `--help`.
    pub about: &'static str,
    /// The choices to start from.
    pub preset: fn(Preset) -> TaskPreset,
    /// What differs where the policy steers a low level, of tasks in which it can.
    pub steering: Option<Steering>,
    /// Refuses choices of the task that cannot work. Returns the dimensions of the environments.
    pub spec: fn(&Config) -> Result<EnvSpec, ConfigError>,
    /// Whether its data is a motion list.
    pub takes_motions: bool,
    /// Loads the data.
    pub load: fn(&Config) -> Result<Loaded>,
    /// The task with recordings that are loaded already, of tasks that take a motion list and steer nothing.
    pub with_recordings: Option<WithRecordings>,
    /// Comparisons of variants that `footwork ablate` knows.
    pub ablations: &'static [Ablation],
}

/// Makes a task of recordings.
pub type WithRecordings = fn(&Config, MotionLibrary) -> Result<Box<dyn Task>>;

/// A task whose policy may steer a low level.
pub struct Steering {
    /// The choices to start from.
    pub preset: fn(Preset) -> TaskPreset,
    /// What `footwork compare` tells besides the success.
    pub measures: &'static [Measure],
    /// Rates of episodes in `metrics.jsonl` whose curves it keeps.
    pub rates: &'static [&'static str],
}

impl TaskEntry {
    /// A preset.
    pub fn config(&self, preset: Preset) -> Config {
        let base = Base {
            preset,
            ..Base::default()
        };
        self.config_of(base)
    }

    /// What a configuration begins with.
    pub fn config_of(&self, base: Base) -> Config {
        Config::preset(self.name, base.preset, self.choices(base))
    }

    /// A preset changed by the keys that a TOML file names. The policy steers a low level if the file names one, or if
    /// it is said here.
    ///
    /// # Errors
    /// See [`ConfigError`].
    pub fn config_from(&self, path: &Path, base: Base) -> Result<Config, ConfigError> {
        let choices = |preset, named| {
            self.choices(Base {
                preset,
                steers: base.steers || named,
                ..base
            })
        };
        Config::from_file(path, self.name, base.preset, &choices)
    }

    fn choices(&self, base: Base) -> TaskPreset {
        let mut chosen = match &self.steering {
            Some(steering) if base.steers => (steering.preset)(base.preset),
            _ => (self.preset)(base.preset),
        };
        if let Some(envs) = base.envs {
            chosen.ppo = chosen.ppo.scaled_to(envs);
        }
        chosen
    }

    /// Refuses what cannot work, before anything is opened or written. Returns the dimensions of the
    /// environments.
    ///
    /// # Errors
    /// [`ConfigError::Value`], or an error of the task or of the networks.
    pub fn check(&self, config: &Config) -> Result<EnvSpec, ConfigError> {
        config.check()?;
        if self.steering.is_none() && config.skills.is_some() {
            return Err(ConfigError::Settings(format!(
                "the task `{}` cannot be done by steering a low level: leave out `skills`",
                self.name
            )));
        }
        let spec = (self.spec)(config)?;
        ActorCritic::new(&config.ppo.network, &spec.observation, spec.action, 1)?;
        if let Some(amp) = &config.amp {
            let latents = config.ase.as_ref().map(|ase| ase.rewards().latents);
            let latents = latents.unwrap_or_default();
            network(amp, 2 * spec.style + latents.shown(), latents)
                .map_err(ConfigError::Discriminator)?;
        }
        if !self.takes_motions && config.reads_for_bodies() {
            return Err(ConfigError::Settings(format!(
                "the task `{}` takes no motion list: leave out `ground`, `data_folder`, `roles` and \
                 `unit_m`, or make a database with `footwork data import`",
                self.name
            )));
        }
        Ok(spec)
    }
}

/// A task with its data, and what the user should know of how it was loaded.
pub struct Loaded {
    /// The task.
    pub task: Box<dyn Task>,
    /// What to tell the user.
    pub notes: Vec<String>,
}

/// A task with its choices made and its data loaded.
pub trait Task: Send + Sync {
    /// The choices that hold: the table `[task]`, but for the name.
    fn settings(&self) -> toml::Table;

    /// The task with the same data under the choices of another configuration.
    ///
    /// # Errors
    /// See [`ConfigError`].
    fn with_choices(&self, config: &Config) -> Result<Box<dyn Task>, ConfigError>;

    /// Fingerprint of the data and the low level: a policy is of no use with others.
    fn fingerprint(&self) -> Fingerprint;

    /// The data in a few words, to be said when a training starts.
    fn describe(&self) -> String;

    /// Opens a rank's share of the environments of a training.
    ///
    /// # Errors
    /// The device cannot hold them.
    fn open(&self, device: &Device, ranks: &Ranks, envs: usize, seed: u32) -> Result<EnvBatch>;

    /// What learns in them.
    ///
    /// # Errors
    /// The networks do not fit the observations, or the device.
    fn learner(
        &self,
        config: &Config,
        envs: &EnvBatch,
        device: &Device,
    ) -> Result<Box<dyn Algorithm>> {
        ppo_learner(config, envs, device)
    }

    /// The low level that policies of this task steer, if they do.
    fn low_level(&self) -> Option<&FrozenLowLevel> {
        None
    }

    /// What moves a simulated body by a policy of this task: the policy itself, unless it steers something
    /// else.
    fn driver(&self, policy: &Policy) -> Box<dyn BodyDriver> {
        Box::new(policy.clone())
    }

    /// Runs `episodes` fixed episodes to their end, the same ones for every policy.
    ///
    /// # Errors
    /// The device was lost.
    fn evaluate(&self, policy: &Policy, episodes: usize) -> Result<Evaluation>;

    /// An evaluation in a sentence without its full stop.
    fn sentence(&self, evaluation: &Evaluation) -> String;

    /// All that `footwork eval` tells of a policy.
    ///
    /// # Errors
    /// [`Unsupported`] if the task has no such thing as is asked for.
    fn report(&self, policy: &Policy, wanted: &EvalOptions) -> Result<EvalReport>;

    /// Environment steps at which a checkpoint is kept for the figures.
    fn milestones(&self) -> &'static [u64] {
        &[]
    }

    /// Draws the figures of a run into its folder: the learning curve, and what else a task has. Returns their files.
    ///
    /// # Errors
    /// A checkpoint cannot be read, or a picture not be written.
    #[cfg(feature = "report")]
    fn figures(&self, run: &RunDir, rows: &[UpdateMetrics]) -> Result<Vec<PathBuf>> {
        draw_curve(run, rows)
    }

    /// What `play`, `train --watch` and `render` show of motion matching.
    fn locomotion(&self) -> Option<&Locomotion> {
        None
    }

    /// What `play` and `render` show of a simulated body.
    fn body(&self) -> Option<BodyEpisodes> {
        None
    }

    /// What two policies of the task fight in, if they do.
    fn bouts(&self) -> Option<Bouts> {
        None
    }
}

/// PPO on the environments' own rewards.
///
/// # Errors
/// The networks do not fit the observations, or the device.
pub fn ppo_learner(
    config: &Config,
    envs: &EnvBatch,
    device: &Device,
) -> Result<Box<dyn Algorithm>> {
    let learner = PpoLearner::new(&config.ppo, envs, device, config.seed)?;
    Ok(Box::new(learner))
}

/// Something was asked of a task that it does not have.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Unsupported(pub String);

/// Variants of a task, to be trained side by side.
pub struct Ablation {
    /// On the command line.
    pub name: &'static str,
    /// A line for `--help`.
    pub about: &'static str,
    /// Folder of its runs unless another is named.
    pub folder: &'static str,
    /// The variants; the first is what the others are compared with.
    pub variants: &'static [Variant],
    /// What is compared besides the success.
    pub measures: &'static [Measure],
    /// Rates of episodes in `metrics.jsonl` whose curves are kept.
    pub rates: &'static [&'static str],
}

/// One way to do it.
pub struct Variant {
    /// Name of its runs' folders, and in tables.
    pub name: &'static str,
    /// The choices of the task that are other than the configuration's.
    pub changes: fn() -> toml::Table,
}

/// A column of a table of evaluations.
pub struct Measure {
    /// Head of the column.
    pub title: &'static str,
    /// In [`Evaluation::measures`].
    pub name: &'static str,
    /// Times this.
    pub unit: f64,
    /// Digits behind the point.
    pub digits: usize,
}

impl Measure {
    /// A fraction, in percent.
    pub const fn percent(title: &'static str, name: &'static str) -> Self {
        Measure {
            title,
            name,
            unit: 100.0,
            digits: 1,
        }
    }

    /// A time, s.
    pub const fn seconds(title: &'static str, name: &'static str) -> Self {
        Measure {
            title,
            name,
            unit: 1.0,
            digits: 2,
        }
    }
}
