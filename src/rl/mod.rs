//! Reinforcement learning: rollouts, advantages, and the algorithms that learn from them.
//!
//! Environments return data; everything that is learning mathematics is here: sampling of actions,
//! generalised advantage estimation, normalisation, the objectives.

pub mod amp;
pub mod ase;
pub mod gae;
pub mod ppo;
pub mod rollout;
pub mod sample_action;
pub mod self_play;
mod step_columns;
pub mod strides;
pub mod task_weight;
pub mod value_normalizer;

use crate::container::{Section, SectionError};
use crate::env::{EnvBatch, Stats};
use crate::nn::policy::Policy;
use anyhow::Result;

/// What an algorithm made of one rollout.
pub struct Iteration {
    /// Losses and what else is worth a curve, by their names in `metrics.jsonl`.
    pub losses: Vec<(&'static str, f64)>,
    /// Sums over the episodes that ended in it.
    pub stats: Stats,
    /// Seconds spent in the networks while acting.
    pub policy_s: f64,
    /// Seconds spent in the environments.
    pub env_s: f64,
    /// Seconds spent learning.
    pub learn_s: f64,
}

impl Iteration {
    /// One of the losses, by name.
    pub fn loss(&self, name: &str) -> Option<f64> {
        let found = self.losses.iter().find(|(other, _)| *other == name);
        found.map(|(_, value)| *value)
    }
}

/// Something that learns from environments.
pub trait Algorithm {
    /// Lets all environments play a rollout and learns from it. `steps` are the environment steps
    /// before it.
    ///
    /// # Errors
    /// The device was lost; or a loss is not finite, and the message names it.
    fn iterate(&mut self, envs: &mut EnvBatch, steps: u64) -> Result<Iteration>;

    /// The policy as it is now, on the host.
    ///
    /// # Errors
    /// The device was lost.
    fn policy(&self) -> Result<Policy>;

    /// Begins with what another training has learned, whose observations are the first numbers of these:
    /// its policy, and of its section what is of use.
    ///
    /// # Errors
    /// It does not fit.
    fn start_from(&mut self, policy: &Policy, section: &mut Section) -> Result<(), SectionError>;

    /// Saves all that learning needs to go on as if it had never stopped, but for the policy itself.
    ///
    /// # Errors
    /// The device was lost.
    fn save(&self, to: &mut Section) -> Result<()>;

    /// Puts back a saved state, and the policy that belongs to it.
    ///
    /// # Errors
    /// They do not fit the configuration.
    fn load(&mut self, from: &mut Section, policy: &Policy) -> Result<(), SectionError>;
}
