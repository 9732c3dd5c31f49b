//! The choices of a run: a preset, changed by a file, changed by the command line.
//!
//! The table `[task]` holds the name of a task and that task's own choices, `[ppo]` those of learning. A
//! change is a TOML table laid over the preset's: keys that the preset does not have are refused.

mod check;
mod overlay;

use crate::gpu::Choice;
use crate::input_file;
use crate::nn::network::NetworkError;
use crate::rl::amp::Amp;
use crate::rl::ase::Ase;
use crate::rl::ppo::Ppo;
use crate::rl::self_play::SelfPlay;
use crate::rl::task_weight::TaskWeightConfig;
pub(super) use check::{check_amp, check_ase, within};
pub use overlay::Difference;
pub(super) use overlay::nearest;
use overlay::{Mistake, different, line_of, names, overlay};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The version of this program, written into all it leaves behind.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// A complete set of choices to start from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// Found by measuring: what trains quickest on two cores.
    #[default]
    Fast,
    /// RLlib's PPO defaults of 2023, which the paper used, but for the critic: its targets are
    /// normalised, its loss is halved, and its clip limits the change of its output.
    Paper,
}

/// The resolved configuration of a run, saved in its folder as `config.toml`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Config {
    /// What the choices began with.
    pub preset: Preset,
    /// Where to train.
    pub device: Choice,
    /// Seed of everything random.
    pub seed: u32,
    /// A BVH file or folder, or a database file, or a motion list; without it the synthetic performer's data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub data: Option<PathBuf>,
    /// The folder of the files that a motion list names; without it the list's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub data_folder: Option<PathBuf>,
    /// Whether recordings whose feet stand off the ground are brought to it, for tasks of a simulated body.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub ground: bool,
    /// A roles file for recordings whose joints are not found, for tasks of a simulated body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roles: Option<PathBuf>,
    /// Metres of one unit of BVH files, for tasks of a simulated body; without it found from the skeletons.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit_m: Option<f32>,
    /// The low level whose skills the policy steers, for tasks of a simulated body: a run's folder, or one of its
    /// checkpoints.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skills: Option<PathBuf>,
    /// Environment steps after which training stops; decisions, where a low level is steered.
    pub steps: u64,
    /// Seconds after which training stops.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_time_s: Option<f64>,
    /// Success over the evaluation episodes at which training stops.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_at_success: Option<f64>,
    /// Environment steps between two looks at `stop_at_success`.
    pub evaluate_every: u64,
    /// Environment steps between two saved checkpoints.
    pub checkpoint_every: u64,
    /// Fraction of the training's time that films of policies may take, made where checkpoints are kept. 0 for none.
    pub film_share: f64,
    /// The task and its own choices.
    pub task: TaskConfig,
    /// The choices of learning.
    pub ppo: Ppo,
    /// Those of a discriminator, for tasks that have one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amp: Option<Amp>,
    /// The choices of latents, for the task that has them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ase: Option<Ase>,
    /// The choices of self-play, for the task that is learned so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub self_play: Option<SelfPlay>,
    /// How the weights of the rewards of task and style are found, for tasks that have both.
    #[serde(skip_serializing_if = "is_default", default)]
    pub task_weight: TaskWeightConfig,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// What a configuration begins with, before any key is changed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Base {
    /// The complete set of choices.
    pub preset: Preset,
    /// Whether it is that of a policy that steers a low level, where the task has both.
    pub steers: bool,
    /// The number of environments that it is scaled to, if not its own: see [`Ppo::scaled_to`].
    pub envs: Option<usize>,
}

/// The choices of a task's preset.
pub struct TaskPreset {
    /// The table `[task]`, but for the name.
    pub settings: toml::Table,
    /// The choices of learning.
    pub ppo: Ppo,
    /// Those of a discriminator, if the task has one.
    pub amp: Option<Amp>,
    /// Those of latents, if the task has any.
    pub ase: Option<Ase>,
    /// The choices of self-play, if the task is learned so.
    pub self_play: Option<SelfPlay>,
    /// Environment steps of a training.
    pub steps: u64,
}

/// A task by name, with its own choices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TaskConfig {
    /// One of the registry: see [`super::tasks::REGISTRY`].
    pub name: String,
    /// What else stands in the table: read by the task.
    #[serde(flatten)]
    pub settings: toml::Table,
}

/// Why a configuration is of no use. All of these are mistakes of usage.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// A file that cannot be read.
    #[error("cannot read {path}: {error}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why it cannot be read.
        error: std::io::Error,
    },
    /// A file that is not TOML, or with a mistake in no line of it in particular.
    #[error("{path}: {message}")]
    Toml {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// An unknown key in a file, or one that takes other values.
    #[error("{path}, line {line}: {problem}")]
    Key {
        /// The file.
        path: PathBuf,
        /// Line of the key, from 1.
        line: usize,
        /// What is wrong with the key or its value.
        problem: String,
    },
    /// A key that cannot be changed so on the command line.
    #[error("--set {key}: {problem}")]
    Set {
        /// The key with its tables, like `ppo.gamma`.
        key: String,
        /// What is wrong with the key or its value.
        problem: String,
    },
    /// A value that cannot work.
    #[error("{key} is {value}: {why}")]
    Value {
        /// The key with its tables, like `ppo.gamma`.
        key: &'static str,
        /// The value as text.
        value: String,
        /// Why it cannot work.
        why: String,
    },
    /// A low level that cannot be steered.
    #[error("{0}")]
    LowLevel(String),
    /// A mistake in a task's own choices.
    #[error("[task]: {0}")]
    Settings(String),
    /// A network that cannot be, or not for the task's observations.
    #[error("ppo.network.{0}")]
    Network(NetworkError),
    /// A discriminator that cannot be.
    #[error("amp.{0}")]
    Discriminator(NetworkError),
    /// A name that no task has.
    #[error("there is no task `{name}`{hint}")]
    Task {
        /// The name.
        name: String,
        /// Suggestion of the nearest name, to follow on the message.
        hint: String,
    },
    /// A run's configuration of a form that this version no longer reads.
    #[error(
        "{path} names no task in its table [task]: it was written by footwork 0.1 from before runs were divided into tables. This is footwork {VERSION}, which does not read it: use the one that wrote it, or train anew"
    )]
    Older {
        /// The file.
        path: PathBuf,
    },
}

// By hand: as its source, an error would be told twice.
impl From<NetworkError> for ConfigError {
    fn from(error: NetworkError) -> Self {
        ConfigError::Network(error)
    }
}

impl Config {
    /// The preset `chosen` of the task called `task`.
    pub(super) fn preset(task: &str, preset: Preset, chosen: TaskPreset) -> Self {
        Config {
            preset,
            device: Choice::Auto,
            seed: 1,
            data: None,
            data_folder: None,
            ground: false,
            roles: None,
            unit_m: None,
            skills: None,
            steps: chosen.steps,
            max_time_s: None,
            stop_at_success: None,
            evaluate_every: 20_000,
            checkpoint_every: 250_000,
            // A film takes a second on a processor: the first is due after 50 s.
            film_share: 0.02,
            task: TaskConfig {
                name: task.to_string(),
                settings: chosen.settings,
            },
            ppo: chosen.ppo,
            amp: chosen.amp,
            ase: chosen.ase,
            self_play: chosen.self_play,
            task_weight: TaskWeightConfig::default(),
        }
    }

    /// One of the presets of the task called `task`, changed by the keys that a TOML file names. `choices` is told
    /// whether these name a low level.
    ///
    /// # Errors
    /// See [`ConfigError`].
    pub(super) fn from_file(
        path: &Path,
        task: &str,
        preset: Preset,
        choices: &dyn Fn(Preset, bool) -> TaskPreset,
    ) -> Result<Self, ConfigError> {
        let text = read(path)?;
        let mut changes = parse(path, &text)?;
        let version = changes.remove("version");
        let preset = match changes.get("preset") {
            Some(named @ toml::Value::String(_)) => {
                let preset = Preset::deserialize(named.clone());
                preset.map_err(|error| toml_error(path, &error))?
            }
            _ => preset,
        };
        let in_file = |mistake: Mistake| match line_of(&text, &mistake.key) {
            Some(line) => ConfigError::Key {
                path: path.to_path_buf(),
                line,
                problem: mistake.problem,
            },
            None => ConfigError::Toml {
                path: path.to_path_buf(),
                message: mistake.problem,
            },
        };
        let skills = changes.get("skills").and_then(toml::Value::as_str);
        let steers = skills.is_some_and(|skills| !skills.is_empty());
        let config = Config::preset(task, preset, choices(preset, steers));
        let config = config.changed(changes).map_err(|mistake| {
            let written = version.as_ref().and_then(toml::Value::as_str);
            let written = written.filter(|version| *version != VERSION);
            let written = written.map(|version| format!(" (footwork {version} wrote this file)"));
            in_file(Mistake {
                problem: mistake.problem + &written.unwrap_or_default(),
                ..mistake
            })
        })?;
        match config.task.name == task {
            true => Ok(config),
            false => Err(in_file(Mistake {
                key: "task.name".to_string(),
                problem: format!("it is of the task `{}`, not of `{task}`", config.task.name),
            })),
        }
    }

    /// The name of the task in a run's `config.toml`.
    ///
    /// # Errors
    /// It cannot be read, or an older version wrote it.
    pub(super) fn task_of(path: &Path) -> Result<String, ConfigError> {
        let table = parse(path, &read(path)?)?;
        let name = table.get("task").and_then(|task| task.get("name"));
        let name = name.and_then(toml::Value::as_str).map(String::from);
        name.ok_or_else(|| ConfigError::Older {
            path: path.to_path_buf(),
        })
    }

    /// Changes one key, like `ppo.gamma`.
    ///
    /// # Errors
    /// There is no such key, or it takes other values; the message has the nearest key.
    pub fn set(&mut self, key: &str, value: toml::Value) -> Result<(), ConfigError> {
        let mistaken = |problem: String| ConfigError::Set {
            key: key.to_string(),
            problem,
        };
        if matches!(key, "preset" | "task.name" | "skills") {
            return Err(mistaken(
                "it decides what all else begins with: give `--preset`, `--skills` or another TASK"
                    .into(),
            ));
        }
        let names = key.rsplit('.');
        let change = names.fold(value, |value, name| {
            toml::Table::from_iter([(name.to_string(), value)]).into()
        });
        let toml::Value::Table(changes) = change else {
            unreachable!("a key has a name")
        };
        *self = self
            .changed(changes)
            .map_err(|mistake| mistaken(mistake.problem))?;
        Ok(())
    }

    /// The choices with `changes` laid over them.
    fn changed(&self, changes: toml::Table) -> Result<Config, Mistake> {
        let mut all = self.complete();
        let names = names(&all, "");
        overlay(&mut all, changes, "", &names)?;
        let mut config: Config = all.try_into().map_err(|error| Mistake {
            key: String::new(),
            problem: one_line(&error),
        })?;
        let named = |path: &PathBuf| !path.as_os_str().is_empty();
        config.data = config.data.filter(named);
        config.data_folder = config.data_folder.filter(named);
        config.roles = config.roles.filter(named);
        config.skills = config.skills.filter(named);
        config.unit_m = config.unit_m.filter(|&unit| unit != 0.0);
        config.max_time_s = config.max_time_s.filter(|&seconds| seconds != 0.0);
        config.stop_at_success = config.stop_at_success.filter(|&success| success != 0.0);
        Ok(config)
    }

    /// Every key there is, those without a value too.
    fn complete(&self) -> toml::Table {
        let mut all = table(self);
        all.entry("data").or_insert("".into());
        all.entry("data_folder").or_insert("".into());
        all.entry("ground").or_insert(false.into());
        all.entry("roles").or_insert("".into());
        all.entry("skills").or_insert("".into());
        all.entry("unit_m").or_insert(0.0.into());
        all.entry("max_time_s").or_insert(0.0.into());
        all.entry("stop_at_success").or_insert(0.0.into());
        let weight = table(&TaskWeightConfig::default());
        all.entry("task_weight").or_insert(weight.into());
        all
    }

    /// The text of a `config.toml`: the version of this program, then every key that has a value.
    pub fn to_toml(&self) -> String {
        format!("version = \"{VERSION}\"\n{}", text(self))
    }

    /// Whether it says how recordings are read for a simulated body.
    pub(super) fn reads_for_bodies(&self) -> bool {
        let read = self.roles.is_some() || self.unit_m.is_some();
        self.ground || self.data_folder.is_some() || read
    }

    /// Environment steps of an update.
    pub fn batch(&self) -> u64 {
        self.ppo.batch() as u64
    }

    /// The first key that decides over what is learned and has another value in the text of another
    /// run's `config.toml`.
    pub fn difference(&self, other: &str) -> Option<Difference> {
        let other = toml::from_str(other).unwrap_or_default();
        different(&decisive(table(self)), &decisive(other), "")
    }

    /// Checksum of the keys that decide over how long an update takes.
    pub(super) fn workload(&self) -> u32 {
        let mut keys = decisive(table(self));
        keys.remove("seed");
        crc32fast::hash(text(&keys).as_bytes())
    }

    /// Refuses rollouts in which an environment could be truncated more than once: there is room for
    /// one final observation.
    pub(super) fn check_rollout(&self, max_steps: u32) -> Result<(), ConfigError> {
        let rollout = self.ppo.rollout_length;
        if rollout <= max_steps as usize {
            return Ok(());
        }
        Err(ConfigError::Value {
            key: "ppo.rollout_length",
            value: rollout.to_string(),
            why: format!(
                "a rollout may hold one truncation of an environment: at most the task's max_steps, {max_steps}"
            ),
        })
    }
}

/// Keys that decide over what is learned.
const DECISIVE: [&str; 7] = [
    "seed",
    "task",
    "ppo",
    "amp",
    "ase",
    "self_play",
    "task_weight",
];

fn decisive(mut all: toml::Table) -> toml::Table {
    all.retain(|key, _| DECISIVE.contains(&key));
    all
}

/// Bytes of the longest configuration.
const MAX_BYTES: u64 = 1 << 24;

fn read(path: &Path) -> Result<String, ConfigError> {
    input_file::text(path, MAX_BYTES).map_err(|error| ConfigError::Read {
        path: path.to_path_buf(),
        error,
    })
}

fn parse(path: &Path, text: &str) -> Result<toml::Table, ConfigError> {
    toml::from_str(text).map_err(|error| toml_error(path, &error))
}

fn toml_error(path: &Path, error: &toml::de::Error) -> ConfigError {
    ConfigError::Toml {
        path: path.to_path_buf(),
        message: one_line(error),
    }
}

fn one_line(error: &toml::de::Error) -> String {
    error.to_string().trim().replace("\nin `", ", in `")
}

/// Plain choices as TOML text.
fn text(choices: &impl Serialize) -> String {
    // Tables of numbers, words and lists always have a TOML form.
    toml::to_string(choices).unwrap_or_default()
}

/// Plain choices as a TOML table. By way of the text, so that 0.1 in single precision stays 0.1.
pub(super) fn table(choices: &impl Serialize) -> toml::Table {
    toml::from_str(&text(choices)).unwrap_or_default()
}

/// The choices that a table holds.
///
/// # Errors
/// It does not hold them, or others besides.
pub(super) fn settings<T: DeserializeOwned>(table: &toml::Table) -> Result<T, ConfigError> {
    let choices = table.clone().try_into();
    choices.map_err(|error: toml::de::Error| ConfigError::Settings(one_line(&error)))
}
