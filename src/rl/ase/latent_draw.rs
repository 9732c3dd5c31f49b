//! Which latents there are, and how likely each is.

use super::{Ase, LowLevel};
use crate::env::humanoid::driver::DriverState;
use crate::kernels::learn::advance_latents::{Params, draw, to_sphere};
use crate::kernels::rng::{gaussian, random4};

/// Random streams: of the clips' latents, of those about them, and of any.
const CLIPS: u32 = 0x434c_4950;
const ABOUT: u32 = 0x4142_4f55;
const ANY: u32 = 0x414e_5953;

/// Which latents there are, and how likely each is.
#[derive(Clone, Debug, PartialEq)]
pub struct LatentDraw {
    /// Numbers of a latent.
    pub dim: usize,
    /// Least and most steps for which one is kept.
    pub kept_steps: [u32; 2],
    /// Standard deviation of latents about their centres.
    pub spread: f32,
    /// `[clips][1 + dim]`: the share of a clip and all before it, then its latent; empty if all directions are as
    /// likely.
    pub centres: Vec<f32>,
}

impl LatentDraw {
    /// The latents of a choice, for clips with these shares of what is recorded.
    pub fn new(ase: &Ase, shares: &[f32]) -> LatentDraw {
        let dim = ase.latent;
        let mut sum = 0.0;
        let centre = |(clip, share): (usize, &f32)| {
            sum += share;
            [vec![sum], direction(clip, dim, CLIPS)].concat()
        };
        let centres = match ase.low_level {
            LowLevel::Ase => Vec::new(),
            LowLevel::PerClip => shares.iter().enumerate().flat_map(centre).collect(),
        };
        LatentDraw {
            dim,
            kept_steps: ase.kept_steps,
            spread: ase.spread,
            centres,
        }
    }

    /// The latent of every clip; empty if clips have none.
    pub fn clips(&self) -> impl Iterator<Item = &[f32]> {
        self.centres.chunks_exact(1 + self.dim).map(|row| &row[1..])
    }

    /// A latent about that of a clip, as agents move under, the same one for the same `number`; empty if clips have
    /// none. A discriminator that was shown the clip's own beside recordings could tell them by it.
    pub fn about_clip(&self, clip: usize, number: usize) -> Vec<f32> {
        let noise = |at: usize| gaussian(random4(clip as u32, number as u32, at as u32, ABOUT));
        let centre = self.clips().nth(clip).unwrap_or_default().iter();
        let mut latent: Vec<f32> = centre
            .enumerate()
            .map(|(at, centre)| centre + self.spread * noise(at))
            .collect();
        to_sphere(&mut latent);
        latent
    }

    /// Draws the latents whose time is over, of so many rows, by a `seed`.
    pub fn advance(&self, rows: usize, seed: u32, state: &mut DriverState) {
        let [least, most] = self.kept_steps;
        let params = Params {
            rows: rows as u32,
            first: 0,
            seed,
            step_counter: state.steps as u32,
            at: 0,
            final_row: 0,
            least,
            most,
            opening: 0,
            spread: self.spread,
        };
        state.latents.resize(rows * self.dim, 0.0);
        state.kept.resize(rows, 0);
        let latents = state.latents.chunks_exact_mut(self.dim);
        for (row, (latent, kept)) in latents.zip(&mut state.kept).enumerate() {
            if *kept == 0 {
                *kept = draw(row as u32, &self.centres, latent, &params);
            }
            *kept -= 1;
        }
        state.steps += 1;
    }

    /// So many latents of all directions, the same ones every time.
    pub fn any(&self, count: usize) -> Vec<Vec<f32>> {
        let latents = (0..count).map(|number| direction(number, self.dim, ANY));
        latents.collect()
    }
}

/// A direction that depends on its number alone, and not on how many there are.
fn direction(number: usize, dim: usize, stream: u32) -> Vec<f32> {
    let number = |at: usize| gaussian(random4(0, number as u32, at as u32, stream));
    let mut latent: Vec<f32> = (0..dim).map(number).collect();
    to_sphere(&mut latent);
    latent
}
