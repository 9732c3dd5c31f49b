//! What a run was asked for: a preset, changed by a file, changed by the command line.

use crate::gpu::Choice;
use crate::motion::normalise::Weights;
use crate::rl::ppo::Ppo;
use crate::nn::layer::Convolution;
use crate::nn::network::Network;
use crate::env::locomotion::{Obstacles, Plane, Task};
use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// A complete set of choices to start from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// Found by measuring: what trains quickest on two cores.
    #[default]
    Fast,
    /// RLlib's PPO defaults of 2023, which the paper used, but for the critic: its targets are
    /// normalised, its loss is halved, and its clip limits the change of its output.
    Paper,
}

/// Which task a run trains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Plane,
    Obstacles,
}

/// The resolved configuration of a run, saved in its folder as `config.toml`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Config {
    pub preset: Preset,
    pub device: Choice,
    pub seed: u32,
    /// A BVH file or folder, or a database file; without it the synthetic performer's data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub data: Option<PathBuf>,
    /// Environment steps after which training stops.
    pub steps: u64,
    /// Seconds after which training stops.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_time_s: Option<f64>,
    /// Success over the evaluation episodes at which training stops.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_success: Option<f64>,
    /// Environment steps between two looks at `stop_success`.
    pub evaluate_every: u64,
    /// Environment steps between two saved checkpoints.
    pub checkpoint_every: u64,
    /// Importance of each group of features in the search.
    pub weights: Weights,
    /// A table of the task's name.
    #[serde(flatten)]
    pub task: Task,
    pub ppo: Ppo,
}

/// Why a configuration is of no use. All of these are mistakes of usage.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    #[error("cannot read {path}: {error}")]
    Read {
        path: PathBuf,
        error: std::io::Error,
    },
    #[error("{path}: {message}")]
    Toml { path: PathBuf, message: String },
    #[error("{path}, line {line}: {problem}")]
    Key {
        path: PathBuf,
        line: usize,
        problem: String,
    },
    #[error("{key} is {value}: {why}")]
    Value {
        key: &'static str,
        value: String,
        why: String,
    },
}

impl Config {
    pub fn preset(kind: Kind, preset: Preset) -> Self {
        let (task, ppo) = match (kind, preset) {
            (Kind::Plane, Preset::Fast) => (Task::Plane(Plane::default()), fast()),
            (Kind::Plane, Preset::Paper) => (Task::Plane(Plane::default()), paper()),
            (Kind::Obstacles, Preset::Fast) => (Task::Obstacles(Obstacles::FAST), fast_obstacles()),
            (Kind::Obstacles, Preset::Paper) => {
                (Task::Obstacles(Obstacles::PAPER), paper_obstacles())
            }
        };
        Config {
            preset,
            device: Choice::Auto,
            seed: 1,
            data: None,
            steps: match kind {
                Kind::Plane => 1_000_000,
                Kind::Obstacles => 6_000_000,
            },
            max_time_s: None,
            stop_success: None,
            evaluate_every: 20_000,
            checkpoint_every: 250_000,
            weights: Weights::PAPER,
            task,
            ppo,
        }
    }

    /// A run's own `config.toml`, whatever its task.
    pub fn of_run(path: &Path) -> Result<Self, ConfigError> {
        let text = read(path)?;
        // What is no TOML at all is told by `overlaid`.
        let table: toml::Table = toml::from_str(&text).unwrap_or_default();
        let kind = match table.contains_key("obstacles") {
            true => Kind::Obstacles,
            false => Kind::Plane,
        };
        Self::overlaid(path, &text, kind, Preset::default())
    }

    /// A preset changed by the keys a TOML file names.
    pub fn from_file(path: &Path, kind: Kind, preset: Preset) -> Result<Self, ConfigError> {
        Self::overlaid(path, &read(path)?, kind, preset)
    }

    fn overlaid(path: &Path, text: &str, kind: Kind, preset: Preset) -> Result<Self, ConfigError> {
        let toml = |message: String| ConfigError::Toml {
            path: path.to_path_buf(),
            message: message.trim().replace("\nin `", ", in `"),
        };
        let changes: toml::Table = toml::from_str(text).map_err(|error| toml(error.to_string()))?;
        let preset = match changes.get("preset") {
            Some(named @ toml::Value::String(_)) => {
                Preset::deserialize(named.clone()).map_err(|error| toml(error.to_string()))?
            }
            _ => preset,
        };
        let mut table = Config::preset(kind, preset)
            .complete()
            .map_err(|error| toml(error.to_string()))?;
        let names = names(&table, "");
        overlay(&mut table, changes, "", &names).map_err(|mistake| ConfigError::Key {
            path: path.to_path_buf(),
            line: line_of(text, &mistake.key).unwrap_or(1),
            problem: mistake.problem,
        })?;
        let mut config: Config = table
            .try_into()
            .map_err(|error: toml::de::Error| toml(error.to_string()))?;
        config.data = config.data.filter(|data| !data.as_os_str().is_empty());
        config.max_time_s = config.max_time_s.filter(|&seconds| seconds != 0.0);
        config.stop_success = config.stop_success.filter(|&success| success != 0.0);
        Ok(config)
    }

    /// Environment steps of an update.
    pub fn batch(&self) -> u64 {
        self.ppo.batch() as u64
    }

    /// Every key there is, those without a value too.
    fn complete(&self) -> Result<toml::Table, toml::ser::Error> {
        let mut table = toml::Table::try_from(self)?;
        table.entry("data").or_insert("".into());
        table.entry("max_time_s").or_insert(0.0.into());
        table.entry("stop_success").or_insert(0.0.into());
        Ok(table)
    }

    /// Rejects what cannot work before anything is opened or written.
    pub fn check(&self) -> Result<(), ConfigError> {
        const LONG: u64 = 1_000_000_000_000_000;
        within("steps", self.steps, 1, LONG)?;
        within("evaluate_every", self.evaluate_every, 1, LONG)?;
        within("checkpoint_every", self.checkpoint_every, 1, LONG)?;
        if let Some(seconds) = self.max_time_s {
            within("max_time_s", seconds, 0.001, 1e9)?;
        }
        if let Some(success) = self.stop_success {
            within("stop_success", success, 0.01, 1.0)?;
        }
        match &self.task {
            Task::Plane(plane) => check_plane(plane)?,
            Task::Obstacles(obstacles) => check_obstacles(obstacles, self.ppo.envs)?,
        }
        check_weights(&self.weights)?;
        check_ppo(&self.ppo)?;
        if self.ppo.horizon > self.task.max_steps() as usize {
            return Err(ConfigError::Value {
                key: "ppo.horizon",
                value: self.ppo.horizon.to_string(),
                why:
                    "a rollout may hold one truncation an environment: at most the task's max_steps"
                        .into(),
            });
        }
        Ok(())
    }
}

fn read(path: &Path) -> Result<String, ConfigError> {
    std::fs::read_to_string(path).map_err(|error| ConfigError::Read {
        path: path.to_path_buf(),
        error,
    })
}

/// A number in its range, ends included; NaN is in none.
fn within<N: PartialOrd + Display>(
    key: &'static str,
    value: N,
    least: N,
    most: N,
) -> Result<(), ConfigError> {
    if least <= value && value <= most {
        return Ok(());
    }
    Err(ConfigError::Value {
        key,
        value: value.to_string(),
        why: format!("it must lie between {least} and {most}"),
    })
}

fn check_plane(plane: &Plane) -> Result<(), ConfigError> {
    within("plane.half_side", plane.half_side, 0.1, 1000.0)?;
    within("plane.reach", plane.reach, 0.001, 1000.0)?;
    within("plane.bonus", plane.bonus, -1e6, 1e6)?;
    within("plane.max_steps", plane.max_steps, 1, 10_000)?;
    if plane.reach < plane.half_side {
        return Ok(());
    }
    Err(ConfigError::Value {
        key: "plane.reach",
        value: plane.reach.to_string(),
        why: "no target can be drawn: it must be less than plane.half_side".into(),
    })
}

fn check_obstacles(task: &Obstacles, envs: usize) -> Result<(), ConfigError> {
    let boxes = envs.saturating_mul(task.count as usize);
    // `reset` looks through all of them up to 32 times, and lavapipe stops after 65,535 iterations.
    within("obstacles.count", task.count, 0, 2000)?;
    within("ppo.envs times obstacles.count", boxes, 0, 1 << 23)?;
    within("obstacles.side_min", task.side_min, 0.001, 1000.0)?;
    within("obstacles.side_max", task.side_max, task.side_min, 1000.0)?;
    within("obstacles.square", task.square, 0.1, 1000.0)?;
    within("obstacles.margin", task.margin, 0.0, 1000.0)?;
    if task.square <= 0.5 * task.side_max + task.margin {
        return Err(ConfigError::Value {
            key: "obstacles.square",
            value: task.square.to_string(),
            why: format!(
                "the start cannot be kept clear: an obstacle of side {} with a margin of {} reaches it from everywhere; it must be over {}",
                task.side_max,
                task.margin,
                0.5 * task.side_max + task.margin
            ),
        });
    }
    within("obstacles.edge", task.edge, 0.0, 100.0)?;
    within("obstacles.look_back", task.look_back, 0.0, 10.0)?;
    within("obstacles.speed", task.speed, 0.0, 100.0)?;
    let (first, last) = (task.half_side_first, task.half_side_last);
    within("obstacles.half_side_first", first, 0.1, 1000.0)?;
    within("obstacles.half_side_last", last, 0.1, 1000.0)?;
    within("obstacles.reach", task.reach, 0.001, 1000.0)?;
    within("obstacles.reach", task.reach, 0.001, first.min(last))?;
    within("obstacles.max_steps", task.max_steps, 1, 10_000)?;
    within("obstacles.hit_reward", task.hit_reward, 0.0, 1e6)?;
    within("obstacles.success_bonus", task.success_bonus, -1e6, 1e6)?;
    within("obstacles.collision", task.collision, -1e6, 0.0)?;
    within("obstacles.pass", task.pass, 0.0, 1.0)
}

fn check_weights(weights: &Weights) -> Result<(), ConfigError> {
    within("weights.foot_position", weights.foot_position, 0.0, 1e3)?;
    within("weights.foot_velocity", weights.foot_velocity, 0.0, 1e3)?;
    within("weights.root_velocity", weights.root_velocity, 0.0, 1e3)?;
    // Actions are divided by these.
    let (position, direction) = (weights.trajectory_position, weights.trajectory_direction);
    within("weights.trajectory_position", position, 1e-3, 1e3)?;
    within("weights.trajectory_direction", direction, 1e-3, 1e3)
}

fn check_ppo(ppo: &Ppo) -> Result<(), ConfigError> {
    within("ppo.envs", ppo.envs, 1, 1 << 20)?;
    within("ppo.horizon", ppo.horizon, 1, 10_000)?;
    within("ppo.envs times ppo.horizon", ppo.batch(), 1, 1 << 23)?;
    within("ppo.epochs", ppo.epochs, 1, 1000)?;
    within("ppo.minibatch", ppo.minibatch, 1, 1 << 23)?;
    within("ppo.learning_rate", ppo.learning_rate, 1e-9, 1.0)?;
    within("ppo.final_rate", ppo.final_rate, 0.0, 1.0)?;
    within("ppo.target_kl", ppo.target_kl, 0.0, 100.0)?;
    within("ppo.gamma", ppo.gamma, 0.0, 1.0)?;
    within("ppo.lambda", ppo.lambda, 0.0, 1.0)?;
    within("ppo.clip", ppo.clip, 1e-3, 100.0)?;
    within("ppo.value_clip", ppo.value_clip, 0.0, 1e6)?;
    within("ppo.value_coefficient", ppo.value_coefficient, 0.0, 1e3)?;
    within("ppo.entropy_coefficient", ppo.entropy_coefficient, 0.0, 1e3)?;
    within("ppo.kl_coefficient", ppo.kl_coefficient, 0.0, 1e3)?;
    within("ppo.kl_target", ppo.kl_target, 1e-6, 100.0)?;
    within("ppo.max_gradient", ppo.max_gradient, 0.0, 1e6)?;
    within("ppo.log_std", ppo.log_std, -10.0, 2.0)?;
    check_network(&ppo.network)
}

fn check_network(network: &Network) -> Result<(), ConfigError> {
    let (hidden, sight) = (&network.hidden, &network.sight);
    within("the length of ppo.network.hidden", hidden.len(), 0, 8)?;
    within("the length of ppo.network.sight", sight.len(), 0, 8)?;
    for &width in hidden {
        within("a width of ppo.network.hidden", width, 1, 2048)?;
    }
    for &width in sight {
        within("a width of ppo.network.sight", width, 1, 2048)?;
    }
    for convolution in &network.convolutions {
        within(
            "filters of ppo.network.convolutions",
            convolution.filters,
            1,
            256,
        )?;
        within("size of ppo.network.convolutions", convolution.size, 1, 16)?;
        within(
            "stride of ppo.network.convolutions",
            convolution.stride,
            1,
            16,
        )?;
    }
    match network.eyes() {
        Some(_) => Ok(()),
        None => Err(ConfigError::Value {
            key: "ppo.network.convolutions",
            value: format!("{:?}", network.convolutions),
            why: "a filter is larger than what it sees: the maps are 16 x 16, and each convolution makes them smaller".into(),
        }),
    }
}

/// Writes `changes` over `table`, refusing keys that `table` does not know and values of another
/// kind. `within` is the table's own name with a dot, if it has one; `names` are all known keys.
fn overlay(
    table: &mut toml::Table,
    changes: toml::Table,
    within: &str,
    names: &[String],
) -> Result<(), Mistake> {
    for (key, value) in changes {
        let full = format!("{within}{key}");
        let put = match (table.get_mut(&key), value) {
            (None, _) => Err(format!("unknown key `{full}`{}", hint(&key, names))),
            (Some(toml::Value::Table(inner)), toml::Value::Table(changes)) => {
                overlay(inner, changes, &format!("{full}."), names)?;
                Ok(())
            }
            (Some(known), value) => put(known, value).map_err(|why| format!("`{full}` must {why}")),
        };
        put.map_err(|problem| Mistake { key: full, problem })?;
    }
    Ok(())
}

/// Writes one value over another of the same kind; the error says what it must be.
fn put(known: &mut toml::Value, value: toml::Value) -> Result<(), String> {
    match (known, value) {
        // Whole numbers stand for numbers.
        (toml::Value::Float(known), toml::Value::Integer(state_u32)) => *known = state_u32 as f64,
        (toml::Value::Integer(_), toml::Value::Integer(..0)) => {
            return Err("not be negative".to_string());
        }
        (known, value) if known.same_type(&value) => *known = value,
        (known, value) => {
            let (wanted, found) = (known.type_str(), value.type_str());
            return Err(format!("be of the type {wanted}, not {found}"));
        }
    }
    Ok(())
}

/// All keys of a table and the tables in it, like `ppo` and `ppo.envs`.
fn names(table: &toml::Table, within: &str) -> Vec<String> {
    let mut all = Vec::new();
    for (key, value) in table {
        all.push(format!("{within}{key}"));
        if let Some(inner) = value.as_table() {
            all.extend(names(inner, &format!("{within}{key}.")));
        }
    }
    all
}

/// Which known key may have been meant, in whatever table it stands.
fn hint(key: &str, names: &[String]) -> String {
    let last = |name: &str| name.rfind('.').map_or(0, |dot| dot + 1);
    names
        .iter()
        .min_by_key(|name| strsim::damerau_levenshtein(key, &name[last(name)..]))
        .map(|name| format!(", did you mean `{name}`?"))
        .unwrap_or_default()
}

/// What is wrong with a key.
struct Mistake {
    /// With the tables it stands in, like `ppo.envs`.
    key: String,
    problem: String,
}

/// The line (from 1) of a TOML text that has a key, if the text is TOML and has it.
fn line_of(text: &str, key: &str) -> Option<usize> {
    let table = toml::de::DeTable::parse(text).ok()?;
    let mut table = table.get_ref();
    let mut names = key.split('.').peekable();
    loop {
        let (name, value) = table.get_key_value(names.next()?)?;
        match (names.peek(), value.get_ref()) {
            (Some(_), toml::de::DeValue::Table(inner)) => table = inner,
            _ => return Some(1 + text[..name.span().start].matches('\n').count()),
        }
    }
}

fn fast() -> Ppo {
    Ppo {
        envs: 256,
        horizon: 16,
        epochs: 3,
        minibatch: 512,
        learning_rate: 2e-3,
        final_rate: 1.0,
        anneal_steps: 0,
        target_kl: 0.0,
        gamma: 0.95,
        lambda: 0.95,
        clip: 0.2,
        value_clip: 0.0,
        value_coefficient: 0.5,
        entropy_coefficient: 0.0,
        kl_coefficient: 0.0,
        kl_target: 0.01,
        max_gradient: 1.0,
        log_std: 0.0,
        network: Network {
            convolutions: Vec::new(),
            sight: Vec::new(),
            hidden: vec![32, 32],
        },
    }
}

fn paper() -> Ppo {
    Ppo {
        envs: 122,
        horizon: 40,
        epochs: 30,
        minibatch: 128,
        learning_rate: 5e-5,
        final_rate: 1.0,
        anneal_steps: 0,
        target_kl: 0.0,
        gamma: 0.99,
        lambda: 1.0,
        clip: 0.3,
        value_clip: 10.0,
        value_coefficient: 1.0,
        entropy_coefficient: 0.0,
        kl_coefficient: 0.2,
        kl_target: 0.01,
        max_gradient: 0.0,
        // The paper names none. At 0 a seed in three is still wandering after 100,000 steps, at 0.3 one
        // in four.
        log_std: 0.6,
        network: Network {
            convolutions: Vec::new(),
            sight: Vec::new(),
            hidden: vec![32, 32],
        },
    }
}

/// Found by measuring: see `BENCHMARKS.md`.
fn fast_obstacles() -> Ppo {
    Ppo {
        horizon: 32,
        epochs: 4,
        minibatch: 1024,
        learning_rate: 7e-4,
        final_rate: 0.05,
        anneal_steps: 6_000_000,
        gamma: 0.99,
        // Wide: who never asks for a run does not learn to run.
        log_std: 1.0,
        network: Network {
            convolutions: vec![
                Convolution {
                    filters: 16,
                    size: 4,
                    stride: 2,
                },
                Convolution {
                    filters: 32,
                    size: 3,
                    stride: 2,
                },
            ],
            sight: vec![128],
            hidden: vec![256, 128],
        },
        ..fast()
    }
}

/// The networks of the paper (its figure 3, right).
fn paper_obstacles() -> Ppo {
    Ppo {
        network: Network {
            convolutions: vec![
                Convolution {
                    filters: 16,
                    size: 4,
                    stride: 1,
                },
                Convolution {
                    filters: 32,
                    size: 3,
                    stride: 1,
                },
            ],
            sight: vec![128],
            hidden: vec![256, 128],
        },
        ..paper()
    }
}
