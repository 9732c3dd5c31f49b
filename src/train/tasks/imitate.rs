//! The task `imitate`: a simulated body moves like recordings, which a discriminator judges.

use super::motions::{self, Performance};
use super::presets::fast;
use crate::env::humanoid::imitate::ImitateTask;
use crate::env::humanoid::imitate::evaluate::{ImitateReport, evaluate};
use crate::env::humanoid::task::{EpisodeRules, open, spec};
use crate::env::{EnvBatch, EnvSpec};
use crate::gpu::Device;
use crate::nn::Policy;
use crate::nn::layer::Activation;
use crate::nn::network::NetworkConfig;
use crate::physics::motion_library::MotionLibrary;
use crate::physics::scenes;
use crate::rl::Algorithm;
use crate::rl::amp::Amp;
use crate::rl::ppo::Ppo;
use crate::train::body_episodes::{BodyEpisodes, EPISODES_SEED};
use crate::train::config::{Config, ConfigError, Preset, TaskPreset, settings, table};
use crate::train::evaluation::{EvalOptions, EvalReport, Evaluation};
use crate::train::task::{Loaded, Task, TaskEntry};
#[cfg(feature = "report")]
use crate::train::{figures, metrics::UpdateMetrics, run_dir::RunDir};
use anyhow::Result;
use std::sync::Arc;

/// The task in the registry.
pub const ENTRY: TaskEntry = TaskEntry {
    name: "imitate",
    about: "Move a simulated body like recordings",
    preset,
    spec: check,
    load,
    ablations: &[],
};

/// The choices of learning of every task that has a discriminator.
pub fn ppo() -> Ppo {
    Ppo {
        envs: 512,
        rollout_length: 16,
        epochs: 4,
        minibatch_size: 2048,
        // It soon finds its own; a higher one throws the first policy away.
        learning_rate: 5e-5,
        critic_learning_rate: 1e-3,
        desired_kl: 0.02,
        adapt_each_minibatch: true,
        gamma: 0.97,
        lambda: 0.95,
        init_log_std: -2.9,
        fixed_std: true,
        normalize_observations: true,
        network: NetworkConfig {
            convolutions: Vec::new(),
            encoder_hidden: Vec::new(),
            hidden: vec![256, 128],
            activation: Activation::Relu,
        },
        ..fast()
    }
}

fn preset(_: Preset) -> TaskPreset {
    TaskPreset {
        settings: table(&EpisodeRules::default()),
        ppo: ppo(),
        amp: Some(Amp::default()),
        steps: 2_500_000,
    }
}

fn check(config: &Config) -> Result<EnvSpec, ConfigError> {
    let rules: EpisodeRules = settings(&config.task.settings)?;
    rules.check().map_err(ConfigError::Settings)?;
    Ok(spec(&scenes::humanoid(), 0, config.ppo.envs))
}

fn load(config: &Config) -> Result<Loaded> {
    let rules = settings(&config.task.settings)?;
    let model = Arc::new(scenes::humanoid());
    let (library, notes) = motions::load(config, &model, Performance::Walk)?;
    let task = ImitateTraining {
        rules,
        library: Arc::new(library),
    };
    Ok(Loaded {
        task: Box::new(task),
        notes,
    })
}

/// A report as the trainer knows it.
fn evaluation(found: &ImitateReport) -> Evaluation {
    let measures = [
        ("episode_length_mean_s", found.mean_episode_s),
        ("speed_ratio", found.speed_ratio),
        ("dtw_m", found.dtw_m),
        ("coverage", found.coverage),
    ];
    Evaluation {
        episodes: found.episodes,
        success: found.survival,
        measures: measures.into_iter().collect(),
    }
}

struct ImitateTraining {
    rules: EpisodeRules,
    library: Arc<MotionLibrary>,
}

impl ImitateTraining {
    fn task(&self, seed: u32) -> Arc<ImitateTask> {
        Arc::new(ImitateTask::new(&self.rules, &self.library, seed))
    }

    fn rate(&self, policy: &Policy, episodes: usize) -> ImitateReport {
        let mean = |observation: &[f32]| policy.mean(observation);
        evaluate(self.task(EPISODES_SEED), &mean, episodes, EPISODES_SEED)
    }
}

impl Task for ImitateTraining {
    fn settings(&self) -> toml::Table {
        table(&self.rules)
    }

    fn with_choices(&self, config: &Config) -> Result<Box<dyn Task>, ConfigError> {
        Ok(Box::new(ImitateTraining {
            rules: settings(&config.task.settings)?,
            library: self.library.clone(),
        }))
    }

    fn fingerprint(&self) -> u32 {
        motions::fingerprint(&self.library)
    }

    fn describe(&self) -> String {
        motions::describe(&self.library)
    }

    fn open(&self, device: &Device, envs: usize, seed: u32) -> Result<EnvBatch> {
        let task = self.task(seed);
        EnvBatch::open(device, envs, None, |part| {
            open(device, task.clone(), part, seed)
        })
    }

    fn learner(
        &self,
        config: &Config,
        envs: &EnvBatch,
        device: &Device,
    ) -> Result<Box<dyn Algorithm>> {
        motions::learner(config, &self.library, envs, device)
    }

    fn evaluate(&self, policy: &Policy, episodes: usize) -> Result<Evaluation> {
        Ok(evaluation(&self.rate(policy, episodes)))
    }

    fn sentence(&self, found: &Evaluation) -> String {
        format!(
            "{:.1} % of {} episodes stay up for {} s, at {:.2} of the recordings' speed, {:.3} m from them",
            100.0 * found.success,
            found.episodes,
            self.rules.episode_s,
            found.measure("speed_ratio"),
            found.measure("dtw_m"),
        )
    }

    fn report(&self, policy: &Policy, wanted: &EvalOptions) -> Result<EvalReport> {
        motions::refuse_matching(wanted)?;
        let found = self.rate(policy, wanted.episodes);
        let evaluation = evaluation(&found);
        Ok(EvalReport {
            text: format!(
                "{}\nepisode {:.2} s on average, coverage of the clips {:.0} %\n",
                self.sentence(&evaluation),
                found.mean_episode_s,
                100.0 * found.coverage,
            ),
            json: serde_json::to_value(found)?,
        })
    }

    #[cfg(feature = "report")]
    fn figures(&self, run: &RunDir, rows: &[UpdateMetrics]) -> Result<()> {
        figures::draw_curve(run, rows)
    }

    fn body(&self) -> Option<BodyEpisodes> {
        let (rules, library) = (self.rules, self.library.clone());
        let task = move |seed| ImitateTask::new(&rules, &library, seed);
        Some(BodyEpisodes::new(task, Some(&self.library)))
    }
}
