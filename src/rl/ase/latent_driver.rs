//! A policy of skills that moves bodies under latents.

use super::LatentDraw;
use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::nn::Policy;

/// The mean of a policy of skills, whose latents change as in training. Latents that its state holds are kept for
/// as long as the state says.
pub struct LatentDriver {
    policy: Policy,
    draw: LatentDraw,
    seed: u32,
}

impl LatentDriver {
    /// A driver whose latents depend on `seed`.
    pub fn new(policy: &Policy, draw: &LatentDraw, seed: u32) -> LatentDriver {
        LatentDriver {
            policy: policy.clone(),
            draw: draw.clone(),
            seed,
        }
    }
}

impl BodyDriver for LatentDriver {
    fn act(&self, observation: &[f32], state: &mut DriverState) -> Vec<f32> {
        let width = self.policy.observation().dim() - self.draw.dim;
        self.draw
            .advance(observation.len() / width, self.seed, state);
        let rows = observation.chunks_exact(width);
        let rows = rows.zip(state.latents.chunks_exact(self.draw.dim));
        let seen: Vec<f32> = rows
            .flat_map(|(row, latent)| row.iter().chain(latent))
            .copied()
            .collect();
        self.policy.mean(&seen)
    }
}
