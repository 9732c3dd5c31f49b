//! The columns of one step, for environments around environments.

use crate::env::Transition;
use crate::gpu::{Array, Device};

/// What one step of inner environments leaves, `[rows]`; of its final observations `[rows][observation]`.
pub(in crate::rl) struct StepColumns {
    pub reward: Array,
    pub style_reward: Array,
    pub termination: Array<u32>,
    pub group: Array<u32>,
    pub final_observation: Array,
}

impl StepColumns {
    /// Room for so many rows, with observations of so many numbers.
    pub fn new(device: &Device, rows: usize, observation: usize) -> Self {
        StepColumns {
            reward: Array::zeroed(device, rows),
            style_reward: Array::zeroed(device, rows),
            termination: Array::zeroed(device, rows),
            group: Array::zeroed(device, rows),
            final_observation: Array::zeroed(device, rows * observation),
        }
    }

    /// The columns as a step fills them.
    pub fn transition(&mut self) -> Transition<'_> {
        Transition {
            step: 0,
            reward: &mut self.reward,
            style_reward: &mut self.style_reward,
            termination: &mut self.termination,
            group: &mut self.group,
            final_observation: &mut self.final_observation,
        }
    }
}
