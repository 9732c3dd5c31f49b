//! What differs between the tasks of the simulated body, and the environments that play any of them.
//!
//! [`HumanoidTask`] is what a task adds to a step of the physics; [`open`] opens a batch of it on either
//! device; [`EpisodeRules`] says how long an episode is and when it has failed.

mod common;
mod cpu;
mod gpu;
pub mod play;
mod rules;

use super::batch::{GpuSimulatorBatch, SimulatedWorld};
use crate::env::vec_env::VecEnv;
use crate::gpu::{Buffer, Device, Gpu};
use crate::kernels::termination;
use crate::physics::model::Model;
use crate::physics::simulator::{STEP_RATE, SUBSTEPS, Simulator};
use anyhow::Result;
use common::Common;
pub use common::{KEY_BODIES, characters, spec};
pub use cpu::CpuHumanoidEnv;
use gpu::GpuHumanoidEnv;
pub use rules::{EpisodeRules, check_range};
use std::ops::Range;
use std::sync::Arc;

/// Length of a step, s.
pub const DT: f32 = SUBSTEPS as f32 / STEP_RATE;

/// What the random numbers of a step depend on, besides the environment's number.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Environments of the batch.
    pub envs: u32,
    /// Number of the first environment in the whole batch.
    pub first: u32,
    /// Seed of the run.
    pub seed: u32,
    /// Steps of the run so far.
    pub step_counter: u32,
}

/// A task of a simulated body, which is the first tree of the model.
///
/// A world carries, besides the physics, [`HumanoidTask::state_dim`] numbers of the task's own. Episodes
/// begin in one of the start states, as [`HumanoidTask::begin`] changes it.
pub trait HumanoidTask: Send + Sync {
    /// What every world simulates.
    fn model(&self) -> &Arc<Model>;

    /// Length and failures of an episode.
    fn rules(&self) -> &EpisodeRules;

    /// States in which episodes begin, `[n][nq + nv]`, each as likely.
    fn start_states(&self) -> &[f32];

    /// An action that keeps the body as it is, `[action]`.
    fn rest_action(&self) -> Vec<f32>;

    /// Names of the statistics: [`COMMON_STATS`], then the task's measures, which are summed over the steps
    /// of an episode.
    fn stat_names(&self) -> &'static [&'static str];

    /// Ends that are successes, `1 << termination`: to be up at the end, unless the task says otherwise.
    fn successes(&self) -> u32 {
        1 << termination::TRUNCATED
    }

    /// Numbers that are observed besides the body's own, which come first.
    fn observation(&self) -> usize {
        0
    }

    /// Numbers that a world carries for the task.
    fn state_dim(&self) -> usize {
        0
    }

    /// Pairs of bodies whose forces on each other are wanted.
    fn force_pairs(&self) -> Vec<[usize; 2]> {
        Vec::new()
    }

    /// Acts on a world before its step.
    fn act(&self, _env: usize, _moment: &Moment, _world: &mut SimulatedWorld) {}

    /// Reward of a step, and how it ends for the task. `simulator` has the kinematics after the step;
    /// `measures` are zero before.
    fn reward(
        &self,
        _simulator: &Simulator,
        _world: &SimulatedWorld,
        _state: &mut [f32],
        _measures: &mut [f32],
    ) -> (f32, u32) {
        (0.0, termination::RUNNING)
    }

    /// Begins an episode: changes the start state that was drawn, `[nq + nv]`, and sets the task's.
    fn begin(&self, _env: usize, _moment: &Moment, _start: &mut [f32], _state: &mut [f32]) {}

    /// Observes what the task adds.
    fn observe(
        &self,
        _simulator: &Simulator,
        _world: &SimulatedWorld,
        _state: &[f32],
        _out: &mut [f32],
    ) {
    }

    /// The same on a GPU.
    fn on_gpu(&self, gpu: &Gpu) -> Box<dyn GpuHumanoidTask>;
}

/// What a task adds to a step on a GPU: see [`HumanoidTask`]. Launches only.
pub trait GpuHumanoidTask: Send {
    /// Acts on the worlds before their step.
    fn act(&self, _worlds: &TaskBuffers, _moment: &Moment) {}

    /// Writes the step's rewards from the index `at` on, and measures and ends.
    fn reward(&self, _worlds: &TaskBuffers, _reward: &Buffer<f32>, _at: usize, _moment: &Moment) {}

    /// Changes the starts of the worlds whose step ended.
    fn begin(&self, _worlds: &TaskBuffers, _moment: &Moment) {}

    /// Observes what the task adds, of the worlds whose step ended as one of `only`, `1 << termination`:
    /// from the index `at` on, a row each `width` numbers.
    fn observe(
        &self,
        _worlds: &TaskBuffers,
        _out: &Buffer<f32>,
        _at: usize,
        _width: usize,
        _only: u32,
    ) {
    }
}

/// The worlds of a batch on a GPU, as tasks see them.
pub struct TaskBuffers {
    /// The device.
    pub gpu: Gpu,
    /// The physics.
    pub batch: GpuSimulatorBatch,
    /// The task's own numbers, `[state_dim][envs]`.
    pub state: Buffer<f32>,
    /// What the task measured of this step, `[measures][envs]`.
    pub measures: Buffer<f32>,
    /// How this step ends for the task, `[envs]`.
    pub task_end: Buffer<u32>,
    /// How it ended, `[envs]`.
    pub ended: Buffer<u32>,
}

/// Statistics of every task.
pub const COMMON_STATS: [&str; 5] = ["episodes", "successes", "steps", "returns", "fall"];

/// Opens the environments `envs` of a batch: what they do depends on their numbers and `seed` alone,
/// not on who else is in this part of the batch. Their first episodes are shorter by a random part, so
/// that not all end at once.
///
/// # Errors
/// More environments than the device has room for.
pub fn open(
    device: &Device,
    task: Arc<dyn HumanoidTask>,
    envs: Range<usize>,
    seed: u32,
) -> Result<Box<dyn VecEnv>> {
    let common = Common::new(task, envs, seed);
    common.batch.check(device)?;
    let limits = common.staggered_limits();
    Ok(match device {
        Device::Cpu => Box::new(CpuHumanoidEnv::new(common, &limits)),
        Device::Gpu(gpu) => Box::new(GpuHumanoidEnv::new(common, &limits, gpu)?),
    })
}
