//! What a run of motion matching has learned, read from its folder or a checkpoint.

use crate::env::locomotion::{EnvConfig, LEVELS, LocomotionTask, Obstacles, Plane};
use crate::nn::Policy;
use crate::train::checkpoint::{Checkpoint, CheckpointError};
use crate::train::config::{Config, ConfigError};
use crate::train::locomotion::split;
use crate::train::run_dir::checkpoint_of;
use std::path::Path;

/// A policy of the plane or among obstacles.
pub struct CharacterPolicy {
    /// Its networks.
    pub policy: Policy,
    /// The task it has learned. Its arena has no walls, since characters of a game need not stay in it.
    pub task: LocomotionTask,
    /// Fingerprint of the database that it was trained with.
    pub fingerprint: u32,
}

/// Why a policy cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PolicyError {
    /// There is no run or checkpoint.
    #[error("{0:#}")]
    Run(anyhow::Error),
    /// The checkpoint cannot be read.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A policy of a simulated body.
    #[error(
        "{path} is a policy of the task `{task}`; characters of motion matching are moved by policies of the tasks `plane` and `obstacles`"
    )]
    Task {
        /// The run or checkpoint.
        path: String,
        /// Its task.
        task: String,
    },
    /// The configuration in the checkpoint does not fit.
    #[error("{path}: the configuration that it was trained with cannot be read: {error}")]
    Config {
        /// The run or checkpoint.
        path: String,
        /// What is wrong with it.
        error: String,
    },
}

impl CharacterPolicy {
    /// Reads the last checkpoint of a run's folder, or the checkpoint that is named itself.
    ///
    /// # Errors
    /// See [`PolicyError`].
    pub fn open(run: &Path) -> Result<Self, PolicyError> {
        let path = checkpoint_of(run).map_err(PolicyError::Run)?;
        let checkpoint = Checkpoint::load(&path)?;
        let path = path.display().to_string();
        let unreadable = |error: String| PolicyError::Config {
            path: path.clone(),
            error,
        };
        let config: Config = toml::from_str(&checkpoint.header.config)
            .map_err(|error| unreadable(error.to_string()))?;
        let task = match checkpoint.header.task.as_str() {
            "plane" => own::<Plane>(&config).map(LocomotionTask::Plane),
            "obstacles" => own(&config).map(|task| {
                LocomotionTask::Obstacles(Obstacles {
                    arena_half_extent: f32::INFINITY,
                    ..task
                })
            }),
            other => {
                let task = other.to_string();
                return Err(PolicyError::Task { path, task });
            }
        };
        let task = task.map_err(|error| unreadable(error.to_string()))?;
        let policy = checkpoint.policy;
        let envs = EnvConfig {
            task,
            envs: 1,
            seed: 0,
            level: LEVELS - 1,
        };
        let spec = envs.spec();
        if *policy.observation() != spec.observation || policy.action() != spec.action {
            let found = format!("its networks are not those of the task `{}`", task.name());
            return Err(unreadable(found));
        }
        Ok(CharacterPolicy {
            policy,
            task,
            fingerprint: checkpoint.header.fingerprint.data,
        })
    }
}

fn own<T: serde::de::DeserializeOwned>(config: &Config) -> Result<T, ConfigError> {
    split(config).map(|(task, _weights)| task)
}
