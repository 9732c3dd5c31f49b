//! Thousands of simulated worlds side by side, as structure of arrays.
//!
//! [`task`] says what is asked of the character; [`gpu`] and [`cpu`] step a batch of worlds by
//! the shaders or by their twins, behind the one trait [`World`].

pub mod cpu;
pub mod gpu;
pub mod task;

use crate::gpu::Device;
use crate::motion::database::Database;
use burn::tensor::Tensor;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
pub use task::Plane;

/// What ended since the last tally.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    pub episodes: f32,
    pub successes: f32,
    /// Summed steps of the ended episodes.
    pub steps: f32,
    /// Summed rewards of the ended episodes.
    pub returns: f32,
}

/// Everything a batch of worlds needs to go on as if never stopped.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Steps so far: the counter of the random numbers.
    pub clock: u32,
    /// `[real::FIELDS][envs]`
    #[serde(skip)]
    pub real: Vec<f32>,
    /// `[whole::FIELDS][envs]`
    #[serde(skip)]
    pub whole: Vec<u32>,
}

/// What the learner needs to judge a rollout, `[horizon * envs]` each and `[envs]` for the ends.
pub struct Values {
    /// The critic's normalised values of the observed states.
    pub observed: Tensor<1>,
    /// Of the states after the last step.
    pub next: Tensor<1>,
    /// Of the last real state of the episode truncated in this rollout, if there was one.
    pub last: Tensor<1>,
    /// Mean and deviation that undo the normalisation.
    pub scale: Tensor<1>,
}

/// A batch of worlds. Tensors stay on the device the worlds live on.
pub trait World {
    fn envs(&self) -> usize;

    /// Observations `[envs, OBSERVATION]`.
    fn observe(&mut self) -> Tensor<2>;

    /// Draws actions `[envs, TRAJECTORY]` from Gaussians and returns them with the logarithm of
    /// their densities `[envs]`.
    fn act(&mut self, mean: Tensor<2>, log_std: Tensor<1>) -> (Tensor<2>, Tensor<1>);

    /// Plays one step, rewards it, and starts a new episode where one ended.
    fn step(&mut self, action: Tensor<2>);

    /// The last real observations `[envs, OBSERVATION]` of truncated episodes. Rows of other
    /// environments are of no meaning.
    fn truncated(&mut self) -> Tensor<2>;

    /// Ends a rollout: advantages and the critic's targets, `[horizon * envs]`, in units of reward.
    fn judge(&mut self, values: Values, gamma: f32, lambda: f32) -> (Tensor<1>, Tensor<1>);

    /// Sums up the episodes that ended since the last call: episodes, successes, steps, return.
    fn tally(&mut self) -> Tensor<1>;

    /// Copies the state to the host. Only between rollouts.
    fn snapshot(&self) -> anyhow::Result<Snapshot>;

    /// Puts a state back.
    fn restore(&mut self, snapshot: &Snapshot);
}

/// A batch of `envs` worlds on `device`, all at the start of an episode.
pub fn open(
    device: &Device,
    database: &Arc<Database>,
    task: Plane,
    envs: usize,
    horizon: usize,
    seed: u32,
) -> Box<dyn World> {
    match device {
        Device::Cpu => Box::new(cpu::CpuWorld::new(
            database.clone(),
            task,
            envs,
            horizon,
            seed,
        )),
        Device::Gpu(gpu) => Box::new(gpu::GpuWorld::new(gpu, database, task, envs, horizon, seed)),
    }
}
