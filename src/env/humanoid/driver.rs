//! Who moves simulated bodies.
//!
//! What a policy does may hang on more than what is observed now: a latent that is held for some steps.
//! A [`BodyDriver`] leaves all it remembers in a [`DriverState`], which its caller keeps: whoever puts an
//! earlier one back sees the same steps again.

use crate::nn::Policy;

/// What a driver remembers from step to step. The default one begins an episode.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DriverState {
    /// Steps so far.
    pub steps: usize,
    /// Latents that are held, `[rows][latent]`; empty where there are none.
    pub latents: Vec<f32>,
    /// Steps for which they are still held, `[rows]`, where that is not the same for all.
    pub kept: Vec<u32>,
}

/// Something that moves simulated bodies by what they observe.
pub trait BodyDriver {
    /// Actions `[rows][action]` for observations `[rows][observation]`. `state` is what the same rows' last
    /// step left, and takes what this one leaves.
    fn act(&self, observation: &[f32], state: &mut DriverState) -> Vec<f32>;
}

/// A policy's mean, which remembers nothing.
impl BodyDriver for Policy {
    fn act(&self, observation: &[f32], _: &mut DriverState) -> Vec<f32> {
        self.mean(observation)
    }
}

impl<F: Fn(&[f32]) -> Vec<f32>> BodyDriver for F {
    fn act(&self, observation: &[f32], _: &mut DriverState) -> Vec<f32> {
        self(observation)
    }
}
