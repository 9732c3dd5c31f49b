//! Thousands of simulated worlds side by side, as structure of arrays.
//!
//! [`task`] says what is asked of the character, [`curriculum`] how its difficulty rises, [`kernel_params`]
//! turns it into the kernels' parameters;
//! [`gpu`] and [`cpu`] step worlds by the shaders or by their twins, behind the one trait [`World`];
//! [`batch`] holds those of a training.

pub mod cpu;
pub mod gpu;
pub mod kernel_params;
pub mod env_state;
pub mod task;
pub mod live_view;

use crate::gpu::Device;
use crate::kernels::locomotion::episode_stats;
use crate::motion::database::Database;
pub use batch::Batch;
use burn::tensor::Tensor;
use rules::KernelParams;
use serde::{Deserialize, Serialize};
pub use snapshot::EnvState;
use std::sync::Arc;
pub use task::{LEVELS, Obstacles, Plane, Task};
use watched::LiveView;

/// What ended since the last tally.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EpisodeStats {
    pub episodes: f64,
    pub successes: f64,
    pub collisions: f64,
    pub truncations: f64,
    /// Summed steps of the ended episodes.
    pub steps: f64,
    /// Summed rewards of the ended episodes.
    pub returns: f64,
}

impl From<[f32; episode_stats::SUMS]> for EpisodeStats {
    fn from(sums: [f32; episode_stats::SUMS]) -> Self {
        let [episodes, successes, collisions, truncations, steps, returns] = sums.map(f64::from);
        EpisodeStats {
            episodes,
            successes,
            collisions,
            truncations,
            steps,
            returns,
        }
    }
}

/// A batch to be opened.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    pub task: Task,
    pub envs: usize,
    /// Steps of a rollout.
    pub horizon: usize,
    pub seed: u32,
    pub level: u32,
}

impl Setup {
    pub fn rules(&self, database: &Database) -> KernelParams {
        KernelParams {
            task: self.task,
            envs: self.envs,
            first: 0,
            horizon: self.horizon,
            candidates: database.candidates.len(),
            seed: self.seed,
            step_counter: 0,
            level: self.level,
        }
    }

    /// Steps by which the limits of the first episodes differ at most.
    fn initial_age_jitter(&self) -> u32 {
        match self.task {
            Task::Plane(plane) => plane.max_steps,
            Task::Obstacles(_) => 0,
        }
    }
}

/// What the learner needs to judge a rollout, `[horizon * envs]` each and `[envs]` for the ends.
pub struct Values {
    /// The critic's normalised values of the observed states.
    pub observed: Tensor<1>,
    /// Of the states after the last step.
    pub next: Tensor<1>,
    /// Of what [`World::last`] returned.
    pub last: Tensor<1>,
    /// Mean and deviation that undo the normalisation.
    pub scale: Tensor<1>,
}

/// Worlds that are stepped together. Tensors stay on the device the worlds live on.
pub trait World: Send {
    /// Observations `[envs, width]`.
    fn observe(&mut self) -> Tensor<2>;

    /// Draws actions `[envs, TRAJECTORY_DIM]` from Gaussians and returns them with the logarithm of
    /// their densities `[envs]`.
    fn act(&mut self, mean: Tensor<2>, log_std: Tensor<1>) -> (Tensor<2>, Tensor<1>);

    /// Plays one step, rewards it, and starts a new episode where one ended.
    fn step(&mut self, action: Tensor<2>);

    /// The last real observations of the episodes that ended in this rollout and whose value goes
    /// on, `[envs, width]` or, if an environment may have several, `[horizon * envs, width]`. Rows of
    /// others are of no meaning.
    fn last(&mut self) -> Tensor<2>;

    /// Ends a rollout: advantages and the critic's targets, `[horizon * envs]`, in units of reward.
    fn judge(&mut self, values: Values, gamma: f32, lambda: f32) -> (Tensor<1>, Tensor<1>);

    /// Sums up the episodes that ended since the last call: the numbers of a [`Tally`] in order.
    fn tally(&mut self) -> Tensor<1>;

    /// Episodes that begin from now on are of this level.
    fn set_level(&mut self, level: u32);

    /// Copies the state to the host. Only between rollouts.
    fn snapshot(&self) -> anyhow::Result<EnvState>;

    /// What there is to see, while the batch goes on.
    ///
    /// # Errors
    /// The device was lost.
    fn watch(&mut self) -> anyhow::Result<LiveView>;

    /// Puts a state back.
    fn restore(&mut self, snapshot: &EnvState);
}

/// Worlds on `device`, all at the start of an episode. On the plane these first episodes
/// have limits of all lengths, so that not all are truncated at once.
pub fn open(device: &Device, database: &Arc<Database>, setup: &Setup) -> Box<dyn World> {
    match device {
        Device::Cpu => Box::new(cpu::CpuLocomotion::new(database.clone(), setup, setup.initial_age_jitter())),
        Device::Gpu(gpu) => Box::new(gpu::GpuLocomotion::new(gpu, database, setup, setup.initial_age_jitter())),
    }
}
