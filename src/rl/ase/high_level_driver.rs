//! A high-level policy that moves bodies through a low level, on the host.

use super::{FrozenLowLevel, STEPS_PER_DECISION};
use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::kernels::learn::low_level_input::to_latent;
use crate::nn::Policy;
use std::sync::Arc;

/// A high-level policy's mean, which decides on a latent at every fifth step; the low level acts by it.
pub struct HighLevelDriver {
    /// Observes what the environments do, and puts out latents.
    pub policy: Policy,
    /// Acts.
    pub low_level: Arc<FrozenLowLevel>,
}

impl BodyDriver for HighLevelDriver {
    fn act(&self, observation: &[f32], state: &mut DriverState) -> Vec<f32> {
        if state.steps.is_multiple_of(STEPS_PER_DECISION) {
            state.latents = self.policy.mean(observation);
            let latents = state.latents.chunks_exact_mut(self.low_level.latent());
            latents.for_each(to_latent);
        }
        state.steps += 1;
        self.low_level.act(observation, &state.latents)
    }
}
