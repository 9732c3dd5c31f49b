//! A low level that moves bodies under one latent.

use super::FrozenLowLevel;
use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::kernels::learn::low_level_input::to_latent;
use std::sync::Arc;

/// A low level under the latent that an action of zeros stands for: nobody steers it.
pub struct FixedLatentDriver {
    low_level: Arc<FrozenLowLevel>,
    /// Numbers of an observation.
    observation: usize,
}

impl FixedLatentDriver {
    /// Who moves bodies that observe so many numbers.
    pub fn new(low_level: &Arc<FrozenLowLevel>, observation: usize) -> FixedLatentDriver {
        FixedLatentDriver {
            low_level: low_level.clone(),
            observation,
        }
    }
}

impl BodyDriver for FixedLatentDriver {
    fn act(&self, observation: &[f32], state: &mut DriverState) -> Vec<f32> {
        let mut latent = vec![0.0; self.low_level.latent()];
        to_latent(&mut latent);
        state.latents = latent.repeat(observation.len() / self.observation);
        state.steps += 1;
        self.low_level.act(observation, &state.latents)
    }
}
