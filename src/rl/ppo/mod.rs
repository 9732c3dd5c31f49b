//! Proximal policy optimisation (Schulman et al. 2017).
//!
//! [`network`] is the form of the networks, of [`layer`]s, [`policy`] holds them, [`rollout`] lets them
//! act, [`update`] improves them by the gradients of a [`loss`] with [`adam`], [`scale`] keeps the
//! critic's targets near one. The networks run, and learn, by kernels of our own on the CPU ([`native`]); on a
//! GPU by launches of our own where all layers are dense (`launched`), else in burn's tensors.

pub mod loss;
pub mod update;

use serde::{Deserialize, Serialize};

/// Everything that may be chosen about learning. Rewards and returns are in the task's units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ppo {
    /// Environments stepped together.
    pub envs: usize,
    /// Steps of every environment between two updates.
    pub rollout_length: usize,
    /// Passes over a rollout.
    pub epochs: usize,
    /// Samples a gradient step.
    pub minibatch_size: usize,
    pub learning_rate: f64,
    /// The learning rate falls linearly to this fraction of itself over `anneal_steps`.
    pub final_lr_fraction: f64,
    /// Environment steps of the fall; 0 for none.
    pub anneal_steps: u64,
    /// After each update the learning rate is divided by 1.5 if the mean KL divergence was over
    /// twice this (down to 1e-5), multiplied by 1.5 if under half of it (up to 1e-2). 0 leaves it
    /// alone.
    pub desired_kl: f64,
    pub gamma: f32,
    pub lambda: f32,
    /// Clip range of the probability ratio.
    pub clip: f64,
    /// Largest change of the critic's normalised output that is rewarded; 0 for no limit.
    pub value_clip: f64,
    pub value_coefficient: f64,
    pub entropy_coefficient: f64,
    /// Weight of a penalty on the KL divergence, adapted towards `kl_penalty_target`; 0 for none.
    pub kl_coefficient: f64,
    pub kl_penalty_target: f64,
    /// Largest norm of the whole gradient; 0 for no limit.
    pub max_grad_norm: f64,
    /// Starting standard deviation of the actions, in normalised units, as a natural logarithm.
    pub init_log_std: f32,
    pub network: network::Network,
}

impl Ppo {
    /// All choices as TOML text, to compare runs by.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }

    /// Samples of one update.
    pub fn batch(&self) -> usize {
        self.envs * self.rollout_length
    }
}
