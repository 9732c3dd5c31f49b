//! What a run was asked for: a preset, changed by a file, changed by the command line.

use crate::gpu::Choice;
use crate::motion::normalise::Weights;
use crate::ppo::Ppo;
use crate::world::Plane;
use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A complete set of choices to start from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// Found by measuring: what trains quickest on two cores.
    #[default]
    Fast,
    /// RLlib's PPO defaults of 2023, which the paper used.
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
    #[error("{path}, line {line}: unknown key `{key}`{hint}")]
    UnknownKey {
        path: PathBuf,
        line: usize,
        key: String,
        hint: String,
    },
    #[error("`{key}` is {value}: {why}")]
    Value {
        key: &'static str,
        value: String,
        why: &'static str,
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
            message,
        };
        let changes: toml::Table =
            toml::from_str(&text).map_err(|error| toml(error.to_string()))?;
        let preset = match changes.get("preset") {
            Some(named) => {
                Preset::deserialize(named.clone()).map_err(|error| toml(error.to_string()))?
            }
            None => preset,
        };
        let mut table = Config::preset(preset)
            .complete()
            .map_err(|error| toml(error.to_string()))?;
        overlay(&mut table, changes, path, &text)?;
        let mut config: Config = table
            .try_into()
            .map_err(|error: toml::de::Error| toml(error.to_string()))?;
        config.data = config.data.filter(|data| !data.as_os_str().is_empty());
        config.max_time_s = config.max_time_s.filter(|&seconds| seconds > 0.0);
        config.stop_success = config.stop_success.filter(|&success| success > 0.0);
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
        let ppo = &self.ppo;
        let positive = |key, value: f64| match value > 0.0 && value.is_finite() {
            true => Ok(()),
            false => Err(ConfigError::Value {
                key,
                value: value.to_string(),
                why: "it must be above zero",
            }),
        };
        positive("ppo.envs", ppo.envs as f64)?;
        positive("ppo.horizon", ppo.horizon as f64)?;
        positive("ppo.epochs", ppo.epochs as f64)?;
        positive("ppo.minibatch", ppo.minibatch as f64)?;
        positive("ppo.learning_rate", ppo.learning_rate)?;
        positive("ppo.clip", ppo.clip)?;
        positive("steps", self.steps as f64)?;
        positive("evaluate_every", self.evaluate_every as f64)?;
        positive("checkpoint_every", self.checkpoint_every as f64)?;
        positive("plane.half_side", self.plane.half_side.into())?;
        positive("plane.reach", self.plane.reach.into())?;
        positive("plane.max_steps", self.plane.max_steps.into())?;
        self.max_time_s
            .map_or(Ok(()), |seconds| positive("max_time_s", seconds))?;
        for (key, value) in [("ppo.gamma", ppo.gamma), ("ppo.lambda", ppo.lambda)] {
            if !(0.0..=1.0).contains(&value) {
                let why = "it must lie between 0 and 1";
                return Err(ConfigError::Value {
                    key,
                    value: value.to_string(),
                    why,
                });
            }
        }
        if ppo.hidden.contains(&0) {
            let why = "a layer needs at least one unit";
            return Err(ConfigError::Value {
                key: "ppo.hidden",
                value: format!("{:?}", ppo.hidden),
                why,
            });
        }
        if self
            .stop_success
            .is_some_and(|success| !(success > 0.0 && success <= 1.0))
        {
            let value = format!("{:?}", self.stop_success);
            return Err(ConfigError::Value {
                key: "stop_success",
                value,
                why: "it is a share, above 0 and up to 1",
            });
        }
        if self.plane.reach >= self.plane.half_side {
            let why = "no target can be drawn: it must be less than plane.half_side";
            return Err(ConfigError::Value {
                key: "plane.reach",
                value: self.plane.reach.to_string(),
                why,
            });
        }
        if ppo.horizon > self.plane.max_steps as usize {
            let why = "a rollout may hold one truncation an environment: at most plane.max_steps";
            return Err(ConfigError::Value {
                key: "ppo.horizon",
                value: ppo.horizon.to_string(),
                why,
            });
        }
        if ppo.envs > 1 << 20 || ppo.batch() > 1 << 26 {
            let why = "at most 1,048,576 environments and 67,108,864 samples an update";
            return Err(ConfigError::Value {
                key: "ppo.envs",
                value: ppo.envs.to_string(),
                why,
            });
        }
        Ok(())
    }
}

/// Writes `changes` over `table`, refusing keys that `table` does not know.
fn overlay(
    table: &mut toml::Table,
    changes: toml::Table,
    path: &Path,
    text: &str,
) -> Result<(), ConfigError> {
    for (key, value) in changes {
        match (table.get_mut(&key), value) {
            (Some(toml::Value::Table(inner)), toml::Value::Table(changes)) => {
                overlay(inner, changes, path, text)?;
            }
            (Some(known), value) => {
                // Whole numbers stand for numbers.
                *known = match (&known, value) {
                    (toml::Value::Float(_), toml::Value::Integer(whole)) => {
                        toml::Value::Float(whole as f64)
                    }
                    (_, value) => value,
                };
            }
            (None, _) => {
                let near = table.keys().max_by(|a, b| {
                    strsim::jaro_winkler(a, &key).total_cmp(&strsim::jaro_winkler(b, &key))
                });
                let hint = near
                    .map(|near| format!("; did you mean `{near}`?"))
                    .unwrap_or_default();
                let line = text
                    .lines()
                    .position(|line| line.trim_start().trim_start_matches('[').starts_with(&key));
                return Err(ConfigError::UnknownKey {
                    path: path.to_path_buf(),
                    line: line.map_or(1, |line| line + 1),
                    key,
                    hint,
                });
            }
        }
    }
    Ok(())
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
        envs: 61,
        horizon: 80,
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
