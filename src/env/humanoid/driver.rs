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

impl DriverState {
    /// The start of an episode of `rows` bodies, whose latents `[rows][latent]` are kept for good.
    pub fn holding(latents: Vec<f32>, rows: usize) -> DriverState {
        DriverState {
            steps: 0,
            latents,
            kept: vec![u32::MAX; rows],
        }
    }
}

/// Something that moves simulated bodies by what they observe.
pub trait BodyDriver: Send + Sync {
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

/// A driver that does the same all the time.
pub struct RepeatAction {
    action: Vec<f32>,
    observation: usize,
}

impl RepeatAction {
    /// Who repeats `action`, `[action]`, whatever it sees of so many numbers.
    pub fn new(action: Vec<f32>, observation: usize) -> Self {
        RepeatAction {
            action,
            observation,
        }
    }
}

impl BodyDriver for RepeatAction {
    fn act(&self, observation: &[f32], _: &mut DriverState) -> Vec<f32> {
        self.action.repeat(observation.len() / self.observation)
    }
}

impl<F: Fn(&[f32]) -> Vec<f32> + Send + Sync> BodyDriver for F {
    fn act(&self, observation: &[f32], _: &mut DriverState) -> Vec<f32> {
        self(observation)
    }
}
