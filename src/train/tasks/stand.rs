//! The task `stand`: a simulated body stays upright for ten seconds while it is pushed.

use super::motions;
use crate::env::humanoid::stand::evaluate::{StandReport, evaluate};
use crate::env::humanoid::stand::{Stand, StandTask};
use crate::env::humanoid::task::{open, spec};
use crate::env::{EnvBatch, EnvSpec};
use crate::gpu::Device;
use crate::nn::Policy;
use crate::nn::layer::Activation;
use crate::nn::network::NetworkConfig;
use crate::physics::scenes;
use crate::ranks::Ranks;
use crate::rl::ppo::Ppo;
use crate::train::body_episodes::{BodyEpisodes, EPISODES_SEED};
use crate::train::config::{Config, ConfigError, Preset, TaskPreset, settings, table};
use crate::train::evaluation::{EvalOptions, EvalReport, Evaluation};
use crate::train::fingerprint::Fingerprint;
use crate::train::task::{Loaded, Task, TaskEntry};
use anyhow::Result;
use std::sync::Arc;

/// The task in the registry.
pub const ENTRY: TaskEntry = TaskEntry {
    name: "stand",
    about: "Keep a simulated body upright while it is pushed",
    preset,
    steering: None,
    spec: check,
    takes_motions: false,
    load,
    with_recordings: None,
    ablations: &[],
};

/// There is no paper whose settings to take: both presets are one.
fn preset(_: Preset) -> TaskPreset {
    TaskPreset {
        settings: table(&Stand::default()),
        ppo: Ppo {
            envs: 512,
            rollout_length: 16,
            epochs: 4,
            minibatch_size: 2048,
            learning_rate: 5e-4,
            desired_kl: 0.02,
            gamma: 0.98,
            lambda: 0.95,
            // Standing is where it begins: more noise than a few degrees makes it fall at once.
            init_log_std: -2.7,
            normalize_observations: true,
            network: NetworkConfig {
                convolutions: Vec::new(),
                encoder_hidden: Vec::new(),
                hidden: vec![256, 128],
                activation: Activation::Relu,
            },
            ..Ppo::default()
        },
        amp: None,
        ase: None,
        self_play: None,
        steps: 2_300_000,
    }
}

fn check(config: &Config) -> Result<EnvSpec, ConfigError> {
    let stand: Stand = settings(&config.task.settings)?;
    stand.check().map_err(ConfigError::Settings)?;
    match config.data {
        Some(_) => Err(ConfigError::Settings(
            "the task `stand` uses no motion: leave out `data`".into(),
        )),
        None => Ok(spec(&scenes::humanoid(), 0, config.ppo.envs)),
    }
}

fn load(config: &Config) -> Result<Loaded> {
    Ok(Loaded {
        task: Box::new(StandTraining::new(config)?),
        notes: Vec::new(),
    })
}

struct StandTraining {
    stand: Stand,
}

impl StandTraining {
    fn new(config: &Config) -> Result<Self, ConfigError> {
        let stand = settings(&config.task.settings)?;
        Ok(StandTraining { stand })
    }

    fn rate(&self, policy: &Policy, episodes: usize) -> StandReport {
        evaluate(&self.stand, policy, episodes, EPISODES_SEED)
    }
}

impl Task for StandTraining {
    fn settings(&self) -> toml::Table {
        table(&self.stand)
    }

    fn with_choices(&self, config: &Config) -> Result<Box<dyn Task>, ConfigError> {
        Ok(Box::new(StandTraining::new(config)?))
    }

    fn fingerprint(&self) -> Fingerprint {
        0.into()
    }

    fn describe(&self) -> String {
        "no motion".to_string()
    }

    fn open(&self, device: &Device, ranks: &Ranks, envs: usize, seed: u32) -> Result<EnvBatch> {
        let task = Arc::new(StandTask::new(&self.stand, seed));
        EnvBatch::open(device, ranks, envs, None, |part| {
            open(device, task.clone(), part, seed)
        })
    }

    fn evaluate(&self, policy: &Policy, episodes: usize) -> Result<Evaluation> {
        let found = self.rate(policy, episodes);
        let measures = [
            ("episode_length_mean_s", found.mean_episode_s),
            ("uprightness", found.mean_uprightness),
        ];
        Ok(Evaluation {
            episodes: found.episodes,
            success: found.survival,
            success_name: "survival",
            measures: measures.into_iter().collect(),
        })
    }

    fn sentence(&self, found: &Evaluation) -> String {
        format!(
            "{:.1} % of {} episodes stay up for {} s, {:.2} s on average",
            100.0 * found.success,
            found.episodes,
            self.stand.rules.episode_s,
            found.measure("episode_length_mean_s")
        )
    }

    fn report(&self, policy: &Policy, wanted: &EvalOptions) -> Result<EvalReport> {
        motions::refuse_matching(wanted)?;
        let found = self.evaluate(policy, wanted.episodes)?;
        Ok(EvalReport {
            text: format!(
                "{}\nmean cosine between the torso and upright: {:.3}\n",
                self.sentence(&found),
                found.measure("uprightness")
            ),
            json: serde_json::to_value(&found)?,
        })
    }

    fn body(&self) -> Option<BodyEpisodes> {
        let stand = self.stand;
        let task = move |seed| Arc::new(StandTask::new(&stand, seed));
        Some(BodyEpisodes::new(task, None))
    }
}
