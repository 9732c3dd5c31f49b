//! A policy of skills that moves bodies under latents.

use super::LatentDraw;
use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::kernels::learn::advance_latents::{Params, draw};
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

    /// Draws the latents whose time is over, of so many rows.
    fn advance(&self, rows: usize, state: &mut DriverState) {
        let [least, most] = self.draw.kept_steps;
        let params = Params {
            rows: rows as u32,
            first: 0,
            seed: self.seed,
            step_counter: state.steps as u32,
            at: 0,
            final_row: 0,
            least,
            most,
            opening: 0,
            spread: self.draw.spread,
        };
        state.latents.resize(rows * self.draw.dim, 0.0);
        state.kept.resize(rows, 0);
        let latents = state.latents.chunks_exact_mut(self.draw.dim);
        for (row, (latent, kept)) in latents.zip(&mut state.kept).enumerate() {
            if *kept == 0 {
                *kept = draw(row as u32, &self.draw.centres, latent, &params);
            }
            *kept -= 1;
        }
        state.steps += 1;
    }
}

impl BodyDriver for LatentDriver {
    fn act(&self, observation: &[f32], state: &mut DriverState) -> Vec<f32> {
        let width = self.policy.observation().dim() - self.draw.dim;
        self.advance(observation.len() / width, state);
        let rows = observation.chunks_exact(width);
        let rows = rows.zip(state.latents.chunks_exact(self.draw.dim));
        let seen: Vec<f32> = rows
            .flat_map(|(row, latent)| row.iter().chain(latent))
            .copied()
            .collect();
        self.policy.mean(&seen)
    }
}
