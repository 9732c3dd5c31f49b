//! Who moves a simulated body, and what its discriminator says of it.

use super::checkpoint::Checkpoint;
use super::config::Config;
use super::task::Task;
use crate::env::VecEnv;
use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::env::humanoid::task::CpuHumanoidEnv;
use crate::env::humanoid::task::play::play_episodes;
use crate::rl::amp::FrozenDiscriminator;
use anyhow::{Context, Result};
use std::sync::Arc;

/// What a checkpoint's policy drives, with its discriminator or its low level's, if there is one.
pub struct BodyPolicy {
    /// Who acts.
    pub driver: Arc<dyn BodyDriver>,
    /// The discriminator.
    pub discriminator: Option<FrozenDiscriminator>,
}

/// What a discriminator says of episodes, of a step on average.
pub struct StyleReport {
    /// The discriminator's reward.
    pub style: f64,
    /// The cosine between the latent and what the encoder finds, if there is one.
    pub encoder_cosine: Option<f64>,
}

impl BodyPolicy {
    /// Reads both from a checkpoint of a run of `task` with this configuration.
    ///
    /// # Errors
    /// The checkpoint is not of such a run.
    pub fn new(mut checkpoint: Checkpoint, config: &Config, task: &dyn Task) -> Result<BodyPolicy> {
        let style = checkpoint.header.spec.style;
        let discriminator = match (task.low_level(), &config.amp) {
            (Some(low_level), _) => Some(low_level.discriminator.clone()),
            (None, None) => None,
            (None, Some(amp)) => {
                let mut learner = checkpoint.sections.take("learner")?;
                let latents = config.ase.as_ref().map(|ase| ase.rewards().latents);
                let latents = latents.unwrap_or_default();
                let loaded = FrozenDiscriminator::load(amp, latents, &mut learner, style);
                Some(loaded.context("the checkpoint's discriminator cannot be read")?)
            }
        };
        Ok(BodyPolicy {
            driver: task.driver(&checkpoint.policy).into(),
            discriminator,
        })
    }

    /// What the discriminator says of one episode of each environment; `None` without one.
    pub fn judged(&self, envs: &mut CpuHumanoidEnv) -> Option<StyleReport> {
        let discriminator = self.discriminator.as_ref()?;
        let (count, own) = (envs.spec().rows(), envs.spec().style);
        let moment = |envs: &CpuHumanoidEnv, row: usize| envs.seen(row)[..own].to_vec();
        let mut before: Vec<Vec<f32>> = (0..count).map(|row| moment(envs, row)).collect();
        let (mut style, mut cosine, mut steps) = (0.0, None, 0usize);
        play_episodes(
            envs,
            &*self.driver,
            DriverState::default(),
            |envs, running, state| {
                let dim = state.latents.len() / count;
                for row in (0..count).filter(|&row| running[row]) {
                    let (now, latent) = (moment(envs, row), &state.latents[row * dim..][..dim]);
                    let moments = [&before[row][..], &now];
                    let (reward, found) = discriminator.reward_and_cosine(moments, latent);
                    style += f64::from(reward);
                    if let Some(found) = found {
                        *cosine.get_or_insert(0.0) += f64::from(found);
                    }
                    steps += 1;
                    before[row] = now;
                }
            },
        );
        let mean = |sum: f64| sum / steps.max(1) as f64;
        Some(StyleReport {
            style: mean(style),
            encoder_cosine: cosine.map(mean),
        })
    }
}
