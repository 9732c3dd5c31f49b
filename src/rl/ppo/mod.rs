//! Proximal policy optimisation (Schulman et al. 2017).
//!
//! [`Ppo`] holds what may be chosen, [`loss`] is the objective of a sample, [`learner`] lets the
//! policy act and improves it, `scaling` is the rule for other numbers of environments.

mod adopt_actor;
mod batch;
pub mod learner;
pub mod loss;
mod scaling;

use crate::nn::network::NetworkConfig;
pub use learner::PpoLearner;
pub use loss::Diversity;
use serde::{Deserialize, Serialize};

/// Everything that may be chosen about learning. Rewards and returns are in the task's units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ppo {
    /// Environments stepped together.
    pub envs: usize,
    /// Steps of every environment between two updates.
    pub rollout_length: usize,
    /// Times that an update goes over its rollout.
    pub epochs: usize,
    /// Samples of a gradient step.
    pub minibatch_size: usize,
    /// Learning rate of Adam, at the start where it is annealed or adapted.
    pub learning_rate: f64,
    /// The learning rate falls linearly to this fraction of itself over `anneal_steps`.
    pub final_lr_fraction: f64,
    /// Environment steps of the fall; 0 for none.
    pub anneal_steps: u64,
    /// Learning rate of the critic; 0 for that of the actor.
    pub critic_learning_rate: f64,
    /// After each update the learning rate is divided by 1.5 if the mean KL divergence was over
    /// twice this (down to 1e-5), multiplied by 1.5 if under half of it (up to 1e-2). 0 leaves it
    /// alone.
    pub desired_kl: f64,
    /// Whether it is adapted before each minibatch instead, between 2e-5 and 3e-3; the critic's stays.
    pub adapt_each_minibatch: bool,
    /// Discount factor of a step.
    pub gamma: f32,
    /// Decay of generalised advantage estimation, per step: 0 for one-step temporal differences, 1 for
    /// whole returns.
    pub lambda: f32,
    /// Clip range of the probability ratio.
    pub clip: f64,
    /// Largest change of the critic's normalised output that is rewarded; 0 for no limit.
    pub value_clip: f64,
    /// Weight of the value loss, half the squared error of the critic's normalised output.
    pub value_coefficient: f64,
    /// Weight of the entropy bonus.
    pub entropy_coefficient: f64,
    /// Weight of a penalty on the KL divergence, adapted towards `kl_penalty_target`; 0 for none.
    pub kl_coefficient: f64,
    /// KL divergence of an update, in nats, that the penalty aims at: its weight grows by half above twice
    /// this, and halves below half of it.
    pub kl_penalty_target: f64,
    /// Largest norm of the whole gradient; 0 for no limit.
    pub max_grad_norm: f64,
    /// Starting standard deviation of the actions, in normalised units, as a natural logarithm.
    pub init_log_std: f32,
    /// Whether the standard deviation of the actions stays as it starts.
    pub fixed_std: bool,
    /// Whether observations are normalised by their running mean and standard deviation.
    pub normalize_observations: bool,
    /// Hidden layers of the actor, and of the critic.
    pub network: NetworkConfig,
}

/// What trains the plane quickest on two cores: what other choices begin with.
impl Default for Ppo {
    fn default() -> Self {
        Ppo {
            envs: 256,
            rollout_length: 16,
            epochs: 3,
            minibatch_size: 512,
            learning_rate: 2e-3,
            final_lr_fraction: 1.0,
            anneal_steps: 0,
            critic_learning_rate: 0.0,
            desired_kl: 0.0,
            adapt_each_minibatch: false,
            gamma: 0.95,
            lambda: 0.95,
            clip: 0.2,
            value_clip: 0.0,
            value_coefficient: 0.5,
            entropy_coefficient: 0.0,
            kl_coefficient: 0.0,
            kl_penalty_target: 0.01,
            max_grad_norm: 1.0,
            init_log_std: 0.0,
            fixed_std: false,
            normalize_observations: false,
            network: NetworkConfig::default(),
        }
    }
}

impl Ppo {
    /// Samples of one update of environments with one agent each.
    pub fn batch(&self) -> usize {
        self.envs * self.rollout_length
    }
}
