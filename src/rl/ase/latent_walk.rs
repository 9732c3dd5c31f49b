//! Latents on the host, as evaluations and viewers need them.

use super::LatentDraw;
use crate::kernels::learn::advance_latents::{Params, draw};

/// The latents of agents, drawn anew when their time is over.
#[derive(Clone, Debug, PartialEq)]
pub struct LatentWalk {
    draw: LatentDraw,
    /// `[rows][latent]`
    pub latents: Vec<f32>,
    /// Steps for which they are still kept, `[rows]`.
    ages: Vec<u32>,
    seed: u32,
    step_counter: u32,
}

impl LatentWalk {
    /// The first latents of so many agents.
    pub fn new(draw: &LatentDraw, rows: usize, seed: u32) -> LatentWalk {
        let mut walk = LatentWalk {
            latents: vec![0.0; rows * draw.dim],
            ages: vec![1; rows],
            draw: draw.clone(),
            seed,
            step_counter: 0,
        };
        walk.advance();
        walk
    }

    /// Lets the latents grow older by a step.
    pub fn advance(&mut self) {
        let [least, most] = self.draw.kept_steps;
        let params = Params {
            rows: self.ages.len() as u32,
            first: 0,
            seed: self.seed,
            step_counter: self.step_counter,
            at: 0,
            final_row: 0,
            least,
            most,
            opening: 0,
            spread: self.draw.spread,
        };
        let latents = self.latents.chunks_exact_mut(self.draw.dim);
        for (row, (latent, age)) in latents.zip(&mut self.ages).enumerate() {
            *age -= 1;
            if *age == 0 {
                *age = draw(row as u32, &self.draw.centres, latent, &params);
            }
        }
        self.step_counter += 1;
    }

    /// Observations `[rows][observation]` with the latents behind them.
    pub fn observed(&self, observations: &[f32]) -> Vec<f32> {
        let width = observations.len() / self.ages.len();
        let latents = self.latents.chunks_exact(self.draw.dim);
        let rows = observations.chunks_exact(width).zip(latents);
        rows.flat_map(|(row, latent)| row.iter().chain(latent))
            .copied()
            .collect()
    }
}
