//! Latents that somebody wants: one that is held, or a way from one to another.

use super::sphere::great_circle;
use crate::env::humanoid::driver::{BodyDriver, DriverState};

/// A way on the sphere of latents, along a great circle; its end is held.
#[derive(Clone, Debug, PartialEq)]
pub struct LatentPath {
    from: Vec<f32>,
    to: Vec<f32>,
    /// The step of the episode at which it begins, and how many it takes.
    begin: usize,
    steps: usize,
}

impl LatentPath {
    /// A way between two latents of length 1 that begins at a step of the episode and takes so many.
    pub fn new(from: Vec<f32>, to: Vec<f32>, begin: usize, steps: usize) -> LatentPath {
        LatentPath {
            from,
            to,
            begin,
            steps,
        }
    }

    /// One latent that is held.
    pub fn held(latent: Vec<f32>) -> LatentPath {
        LatentPath::new(latent.clone(), latent, 0, 0)
    }

    /// The latent that is held in the end.
    pub fn end(&self) -> &[f32] {
        &self.to
    }

    /// The latent of a step of the episode.
    pub fn latent(&self, step: usize) -> Vec<f32> {
        match (step + 1).saturating_sub(self.begin) {
            gone if gone >= self.steps => self.to.clone(),
            gone => great_circle(&self.from, &self.to, gone as f32 / self.steps as f32),
        }
    }
}

/// A driver of one body, whose latents are those of a way.
pub struct SteeredDriver<'a> {
    /// Who acts.
    pub driver: &'a dyn BodyDriver,
    /// What it acts under.
    pub path: &'a LatentPath,
}

impl BodyDriver for SteeredDriver<'_> {
    fn act(&self, observation: &[f32], state: &mut DriverState) -> Vec<f32> {
        state.latents = self.path.latent(state.steps);
        // Whoever lets go of it finds that its time is over.
        state.kept = vec![1];
        self.driver.act(observation, state)
    }
}
