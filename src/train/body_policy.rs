//! Who moves a simulated body, and what its discriminator says of it.

use super::checkpoint::Checkpoint;
use super::config::Config;
use super::task::Task;
use crate::env::humanoid::driver::BodyDriver;
use crate::env::humanoid::recorded::observe;
use crate::env::humanoid::task::CpuHumanoidEnv;
use crate::env::humanoid::task::play::play_episodes;
use crate::rl::amp::FrozenDiscriminator;
use anyhow::{Context, Result};

/// What a checkpoint's policy drives, with its discriminator if the run has one.
pub struct BodyPolicy {
    /// Who acts.
    pub driver: Box<dyn BodyDriver>,
    /// The discriminator.
    pub discriminator: Option<FrozenDiscriminator>,
}

impl BodyPolicy {
    /// Those of a checkpoint of a run of `task` with this configuration.
    ///
    /// # Errors
    /// The checkpoint is not of such a run.
    pub fn new(mut checkpoint: Checkpoint, config: &Config, task: &dyn Task) -> Result<BodyPolicy> {
        let style = checkpoint.header.spec.style;
        let discriminator = match &config.amp {
            None => None,
            Some(amp) => {
                let mut learner = checkpoint.sections.take("learner")?;
                let loaded = FrozenDiscriminator::load(amp, &mut learner, style);
                Some(loaded.context("the checkpoint's discriminator cannot be read")?)
            }
        };
        Ok(BodyPolicy {
            driver: task.driver(&checkpoint.policy),
            discriminator,
        })
    }

    /// Mean style reward of a step, over one episode of each environment; `None` without a discriminator.
    pub fn mean_style(&self, envs: &mut CpuHumanoidEnv) -> Option<f64> {
        let discriminator = self.discriminator.as_ref()?;
        let moment = |envs: &CpuHumanoidEnv, env: usize| {
            let state = &envs.batch.worlds[env].state;
            observe(envs.task().model(), &state.q, &state.v)
        };
        let count = envs.batch.worlds.len();
        let mut before: Vec<Vec<f32>> = (0..count).map(|env| moment(envs, env)).collect();
        let (mut sum, mut steps) = (0.0, 0usize);
        play_episodes(envs, &*self.driver, |envs, running| {
            for env in (0..count).filter(|&env| running[env]) {
                let now = moment(envs, env);
                sum += f64::from(discriminator.reward([&before[env], &now]));
                steps += 1;
                before[env] = now;
            }
        });
        Some(sum / steps.max(1) as f64)
    }
}
