//! What an environment observes, how it acts, and how long a step lasts.

use crate::kernels::termination;
pub use crate::nn::observation::ObservationSpec;
use serde::{Deserialize, Serialize};

/// The dimensions of a batch of environments. Rows of a batch are `envs * agents`, the agents of an
/// environment side by side.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnvSpec {
    /// Environments stepped together.
    pub envs: usize,
    /// Agents of an environment: two fighters of one world are two rows.
    pub agents: usize,
    /// Form of an agent's observation.
    pub observation: ObservationSpec,
    /// Numbers of an observation, from its first on, that say how an agent moves: what a discriminator
    /// sees. 0 if it moves in no style.
    #[serde(default)]
    pub style: usize,
    /// Numbers of an action.
    pub action: usize,
    /// Length of a step, s.
    pub dt: f32,
    /// Terminations after which the value of the final observation goes on (Gymnasium's truncation),
    /// the bit `1 << termination` for each.
    pub bootstrap: u32,
    /// Whether an environment may have two such terminations in one rollout. If not, one row of final
    /// observations suffices for it, whatever the length of the rollout.
    pub bootstraps_often: bool,
}

impl EnvSpec {
    /// Environments with one agent each, which observes plain numbers and moves in no style. Episodes that are
    /// truncated, of which a rollout may hold any number, are valued as if they went on.
    pub fn new(envs: usize, observation: usize, action: usize, dt: f32) -> EnvSpec {
        EnvSpec {
            envs,
            agents: 1,
            observation: ObservationSpec {
                vector: observation,
                grid: None,
            },
            style: 0,
            action,
            dt,
            bootstrap: 1 << termination::TRUNCATED,
            bootstraps_often: true,
        }
    }

    /// Rows of a batch.
    pub fn rows(&self) -> usize {
        self.envs * self.agents
    }

    /// Steps whose final observations a rollout of `length` steps keeps.
    pub fn final_steps(&self, length: usize) -> usize {
        if self.bootstraps_often { length } else { 1 }
    }

    /// The first row that the step `step` of a rollout writes final observations to.
    pub fn final_row(&self, step: usize) -> usize {
        if self.bootstraps_often {
            step * self.rows()
        } else {
            0
        }
    }
}
