//! What a task adds to a step of the physics.

use super::rules::EpisodeRules;
use crate::env::description::VectorPart;
use crate::env::humanoid::batch::{GpuSimulatorBatch, SimulatedWorld};
use crate::gpu::{Buffer, Gpu};
use crate::kernels::termination;
use crate::physics::model::Model;
use crate::physics::simulator::{Simulator, SimulatorState};
use glam::Vec2;
use std::sync::Arc;

/// What the random numbers of a step depend on, besides the environment's number.
#[derive(Clone, Copy, Debug)]
pub struct StepContext {
    /// Environments of the batch.
    pub envs: u32,
    /// Number of the first environment in the whole batch.
    pub first: u32,
    /// Seed of the run.
    pub seed: u32,
    /// Steps of the run so far.
    pub step_counter: u32,
}

/// A task of simulated bodies: the agents of a world are the trees of its model that have drives.
///
/// A world carries, besides the physics, [`HumanoidTask::state_dim`] numbers of the task's own. Episodes
/// begin in one of the start states, as [`HumanoidTask::begin`] changes it.
pub trait HumanoidTask: Send + Sync {
    /// What every world simulates.
    fn model(&self) -> &Arc<Model>;

    /// Length and failures of an episode.
    fn rules(&self) -> &EpisodeRules;

    /// States in which episodes begin, `[n][nq + nv]`, each as likely. Of several agents each draws its own,
    /// `[n][(nq + nv) / agents]`.
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

    /// Ends after which the value of the final observation goes on, `1 << termination`.
    fn bootstrap(&self) -> u32 {
        1 << termination::TRUNCATED | 1 << termination::SUCCESS
    }

    /// Whether a fall ends the episode. If not, the task sees to falls itself.
    fn falls_end(&self) -> bool {
        true
    }

    /// Numbers that are observed besides the body's own, which come first.
    fn observation(&self) -> usize {
        0
    }

    /// What each of these numbers means.
    fn describe(&self) -> Vec<VectorPart> {
        Vec::new()
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
    fn act(&self, _env: usize, _moment: &StepContext, _world: &mut SimulatedWorld) {}

    /// Writes what a step comes to for each agent. `simulator` has the kinematics after the step; `outcomes`,
    /// `[agents]`, and `measures`, `[agents][measures]`, are zero before. It ends for all agents or for none.
    fn reward(
        &self,
        _moment: &StepContext,
        _simulator: &Simulator,
        _world: &SimulatedWorld,
        _state: &mut [f32],
        _outcomes: &mut [StepOutcome],
        _measures: &mut [f32],
    ) {
    }

    /// Begins an episode: changes the start state that was drawn, `[nq + nv]`, and sets the task's.
    fn begin(&self, _env: usize, _moment: &StepContext, _start: &mut [f32], _state: &mut [f32]) {}

    /// Positions at which a body should be now, if the task says so.
    fn wanted(&self, _state: &[f32]) -> Option<&[f32]> {
        None
    }

    /// Puts the target elsewhere on the ground, m, if the task has one.
    fn move_target(&self, _at: [f32; 2], _world: &mut SimulatorState, _state: &mut [f32]) {}

    /// Says where somebody wants the body to move and to face, unit vectors on the ground, if the task has such wishes.
    fn steer(&self, _moving: Vec2, _facing: Vec2, _state: &mut [f32]) {}

    /// Observes what the task adds for an agent.
    fn observe(
        &self,
        _agent: usize,
        _simulator: &Simulator,
        _world: &SimulatedWorld,
        _state: &[f32],
        _out: &mut [f32],
    ) {
    }

    /// What the task adds to a step on a GPU.
    fn on_gpu(&self, gpu: &Gpu) -> Box<dyn GpuHumanoidTask>;
}

/// What a task adds to a step on a GPU: see [`HumanoidTask`]. Launches only.
pub trait GpuHumanoidTask: Send {
    /// Acts on the worlds before their step.
    fn act(&self, _worlds: &TaskBuffers, _moment: &StepContext) {}

    /// Writes the step's rewards and groups from the index `at` on, and measures and ends.
    fn reward(
        &self,
        _worlds: &TaskBuffers,
        _reward: &Buffer<f32>,
        _group: &Buffer<u32>,
        _at: usize,
        _moment: &StepContext,
    ) {
    }

    /// Changes the starts of the worlds whose step ended.
    fn begin(&self, _worlds: &TaskBuffers, _moment: &StepContext) {}

    /// Observes what the task adds, of the agents of worlds whose step ended as one of `only`,
    /// `1 << termination`: from the index `at` on, a row each `width` numbers.
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
    /// What the task measured of this step, `[measures][rows]`.
    pub measures: Buffer<f32>,
    /// How this step ends for the task, `[rows]`: see [`StepOutcome::end`].
    pub task_end: Buffer<u32>,
    /// How it ended, `[envs]`.
    pub ended: Buffer<u32>,
}

/// What a step comes to for an agent of a task.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepOutcome {
    /// Its reward.
    pub reward: f32,
    /// How it ends for the task, see [`termination`]; [`termination::LEADS`] added if the episode, should it
    /// end now, is a success whatever [`HumanoidTask::successes`] says.
    pub end: u32,
    /// See [`Transition::group`](crate::env::Transition::group).
    pub group: u32,
}

/// Statistics of every task.
pub const COMMON_STATS: [&str; 5] = ["episodes", "successes", "steps", "returns", "fall"];
