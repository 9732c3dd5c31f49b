//! Which latents there are, and how likely each is.

use super::{Ase, LowLevel};
use crate::kernels::learn::advance_latents::to_sphere;
use crate::kernels::rng::{gaussian, random4};

/// Random stream of the clips' latents.
const STREAM: u32 = 0x434c_4950;

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
            [vec![sum], clip_latent(clip, dim)].concat()
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
}

/// A direction that does not depend on how many clips there are.
fn clip_latent(clip: usize, dim: usize) -> Vec<f32> {
    let number = |at: usize| gaussian(random4(0, clip as u32, at as u32, STREAM));
    let mut latent: Vec<f32> = (0..dim).map(number).collect();
    to_sphere(&mut latent);
    latent
}
