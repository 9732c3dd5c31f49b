//! What a run was asked for: a preset, changed by a file, changed by the command line.

use crate::gpu::Choice;
use crate::motion::normalise::Weights;
use crate::ppo::Ppo;
use crate::world::Plane;
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

/// The resolved configuration of a run, saved in its folder as `config.toml`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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
    pub plane: Plane,
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
    pub fn preset(preset: Preset) -> Self {
        Config {
            preset,
            device: Choice::Auto,
            seed: 1,
            data: None,
            steps: 1_000_000,
            max_time_s: None,
            stop_success: None,
            evaluate_every: 20_000,
            checkpoint_every: 250_000,
            weights: Weights::PAPER,
            plane: Plane::default(),
            ppo: match preset {
                Preset::Fast => fast(),
                Preset::Paper => paper(),
            },
        }
    }

    /// A preset changed by the keys a TOML file names.
    pub fn from_file(path: &Path, preset: Preset) -> Result<Self, ConfigError> {
        let text = std::fs::read_to_string(path).map_err(|error| ConfigError::Read {
            path: path.to_path_buf(),
            error,
        })?;
        let toml = |message: String| ConfigError::Toml {
            path: path.to_path_buf(),
            message: message.trim().replace("\nin `", ", in `"),
        };
        let changes: toml::Table =
            toml::from_str(&text).map_err(|error| toml(error.to_string()))?;
        let preset = match changes.get("preset") {
            Some(named @ toml::Value::String(_)) => {
                Preset::deserialize(named.clone()).map_err(|error| toml(error.to_string()))?
            }
            _ => preset,
        };
        let mut table = Config::preset(preset)
            .complete()
            .map_err(|error| toml(error.to_string()))?;
        let names = names(&table, "");
        overlay(&mut table, changes, "", &names).map_err(|mistake| ConfigError::Key {
            path: path.to_path_buf(),
            line: line_of(&text, &mistake.key).unwrap_or(1),
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
        check_plane(&self.plane)?;
        check_weights(&self.weights)?;
        check_ppo(&self.ppo)?;
        if self.ppo.horizon > self.plane.max_steps as usize {
            return Err(ConfigError::Value {
                key: "ppo.horizon",
                value: self.ppo.horizon.to_string(),
                why: "a rollout may hold one truncation an environment: at most plane.max_steps"
                    .into(),
            });
        }
        Ok(())
    }
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
    within("the length of ppo.hidden", ppo.hidden.len(), 0, 8)?;
    let mut widths = ppo.hidden.iter();
    widths.try_for_each(|&width| within("a width of ppo.hidden", width, 1, 2048))
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
        (toml::Value::Float(known), toml::Value::Integer(whole)) => *known = whole as f64,
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
        hidden: vec![32, 32],
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
        log_std: 0.0,
        hidden: vec![32, 32],
    }
}
