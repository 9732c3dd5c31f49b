//! Who moves a simulated body, and what its discriminator says of it.

use super::checkpoint::Checkpoint;
use super::config::Config;
use crate::nn::Policy;
use crate::rl::amp::FrozenDiscriminator;
use anyhow::{Context, Result};

/// A checkpoint's policy, with its discriminator if the run has one.
pub struct BodyPolicy {
    /// The policy.
    pub policy: Policy,
    /// The discriminator.
    pub discriminator: Option<FrozenDiscriminator>,
}

impl BodyPolicy {
    /// Those of a checkpoint of a run with this configuration.
    ///
    /// # Errors
    /// The checkpoint is not of such a run.
    pub fn new(mut checkpoint: Checkpoint, config: &Config) -> Result<BodyPolicy> {
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
            policy: checkpoint.policy,
            discriminator,
        })
    }
}
