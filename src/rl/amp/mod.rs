//! Adversarial motion priors (Peng et al. 2021): a discriminator learns to tell recorded motion from that
//! of the agents, who are rewarded for being taken for recordings.
//!
//! [`Amp`] holds what may be chosen, [`discriminator`] learns and rewards, [`learner`] is PPO with both; a
//! [`frozen_discriminator`] is what is left when learning is over, and a [`BatchDiscriminator`] the same on a
//! device. [`LatentUse`] is what a discriminator makes of the latents of [skills](super::ase).

mod adaptive_steps;
mod batch_discriminator;
pub mod discriminator;
pub mod frozen_discriminator;
pub mod latent_use;
pub mod learner;
mod loss;
mod replay;
pub(in crate::rl) mod style;

pub use batch_discriminator::BatchDiscriminator;
pub use discriminator::Discriminator;
pub use frozen_discriminator::FrozenDiscriminator;
pub use latent_use::{LatentUse, SkillRewards};
pub use learner::AmpLearner;
use serde::{Deserialize, Serialize};

/// What a discriminator loses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DiscriminatorLoss {
    /// Binary cross-entropy; the reward is -log(1 - sigmoid(D)).
    Bce,
    /// The hinge; the reward is D within 1 of zero (Xu and Karamouzas 2021).
    Hinge,
}

/// Everything that may be chosen about the discriminator and its reward.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Amp {
    /// What the discriminator loses.
    pub loss: DiscriminatorLoss,
    /// Its outputs, whose mean counts: an ensemble over one trunk.
    pub heads: usize,
    /// Widths of its hidden layers, which are ReLUs.
    pub hidden: Vec<usize>,
    /// Its gradient steps in an update.
    pub steps: usize,
    /// Recorded windows of a step. There are as many of agents: half of them of the present rollout, half
    /// replayed.
    pub minibatch_size: usize,
    /// Learning rate of Adam.
    pub learning_rate: f64,
    /// Largest norm of the whole gradient; 0 for no limit.
    pub max_grad_norm: f64,
    /// Weight of the mean squared norm of the gradient with respect to recorded windows.
    pub gradient_penalty: f32,
    /// Weight decay of the last layer.
    pub logit_decay: f32,
    /// Windows of agents that are kept for replay.
    pub replay_capacity: usize,
    /// Windows of each update that enter the replay, in place of the oldest.
    pub replay_per_update: usize,
    /// Weight of the advantages of the style reward; where a rule finds the weights, what they begin with.
    pub style_weight: f32,
    /// Weight of the advantages of the task's reward, likewise; 0 if the task has none.
    pub task_weight: f32,
}

impl Amp {
    /// Ratio of the weights of task and style.
    pub fn lambda(&self) -> f64 {
        f64::from(self.task_weight) / f64::from(self.style_weight)
    }
}

impl Default for Amp {
    /// What learned quickest on two cores: small networks, many small steps.
    fn default() -> Self {
        Amp {
            loss: DiscriminatorLoss::Bce,
            heads: 1,
            hidden: vec![256, 128],
            steps: 8,
            minibatch_size: 1024,
            learning_rate: 2e-4,
            max_grad_norm: 1.0,
            gradient_penalty: 5.0,
            logit_decay: 0.01,
            replay_capacity: 20_480,
            replay_per_update: 2048,
            style_weight: 1.0,
            task_weight: 0.0,
        }
    }
}
