//! What environments on both devices need to know: the model, the kernels' parameters.

use super::humanoid_task::{COMMON_STATS, HumanoidTask, StepContext};
use super::rules::DT;
use crate::env::humanoid::action::action_scale;
use crate::env::humanoid::batch::{MAX_SPEED, SimulatorBatchConfig};
use crate::env::spec::{EnvSpec, ObservationSpec};
use crate::kernels::humanoid::{action_targets, draw_starts, end_episode};
use crate::kernels::physics::proprioception;
use crate::kernels::rng::{index_below, random4};
use crate::kernels::termination::{SUCCESS, TRUNCATED};
use crate::physics::model::Model;
use crate::physics::simulator::SolverOptions;
use std::ops::Range;
use std::sync::Arc;

/// Bodies whose positions are observed.
pub const KEY_BODIES: [&str; 4] = ["right_hand", "left_hand", "right_foot", "left_foot"];

/// Stream of the lengths of first episodes.
const STREAM: u32 = 0x4147_4553;

/// The dimensions of `envs` environments of a task that adds so many numbers to the observation of the
/// body, the first tree of the model.
pub fn spec(model: &Model, task_observation: usize, envs: usize) -> EnvSpec {
    let body = proprioception::width(model, 0, KEY_BODIES.len());
    EnvSpec {
        envs,
        agents: 1,
        observation: ObservationSpec {
            vector: body + task_observation,
            grid: None,
        },
        style: body,
        action: model.nu(),
        dt: DT,
        bootstrap: 1 << TRUNCATED | 1 << SUCCESS,
        bootstraps_often: true,
    }
}

/// The argument of [`proprioception`]: one character, the first tree, and its key bodies.
pub fn characters(model: &Model) -> Vec<u32> {
    let keys = KEY_BODIES.map(|name| body(model, name));
    [&[keys.len() as u32, 0], &keys[..]].concat()
}

pub struct Common {
    pub task: Arc<dyn HumanoidTask>,
    pub spec: EnvSpec,
    pub batch: SimulatorBatchConfig,
    /// Number of the first environment in the whole batch.
    pub first: usize,
    /// `[2][nu]`, see [`action_scale`].
    pub action_scale: Vec<f32>,
    /// See [`characters`].
    pub characters: Vec<u32>,
    /// Steps of the run so far: the random numbers' counter.
    pub step_counter: u32,
    /// Numbers that the task measures of a step.
    pub measures: usize,
}

impl Common {
    pub fn new(task: Arc<dyn HumanoidTask>, envs: Range<usize>, seed: u32) -> Common {
        let model = task.model().clone();
        Common {
            spec: spec(&model, task.observation(), envs.len()),
            first: envs.start,
            action_scale: action_scale(&model),
            characters: characters(&model),
            step_counter: 0,
            measures: task.stat_names().len() - COMMON_STATS.len(),
            batch: SimulatorBatchConfig {
                envs: envs.len(),
                options: SolverOptions::fast(&model),
                seed,
                force_pairs: task.force_pairs(),
                model,
            },
            task,
        }
    }

    /// Steps after which the first episode of each environment is truncated, `[envs]`.
    pub fn staggered_limits(&self) -> Vec<f32> {
        let steps = self.task.rules().steps();
        let numbers = self.first..self.first + self.spec.envs;
        let limits = numbers.map(|env| {
            let [bits, ..] = random4(self.batch.seed, env as u32, 0, STREAM);
            steps - index_below(bits, steps)
        });
        limits.map(|steps| steps as f32).collect()
    }

    /// Each moment has a counter of its own: zero is that of the opening.
    pub fn moment(&self) -> StepContext {
        StepContext {
            envs: self.spec.envs as u32,
            first: self.first as u32,
            seed: self.batch.seed,
            step_counter: self.step_counter,
        }
    }

    /// Numbers that the body observes of itself.
    pub fn body_dim(&self) -> usize {
        self.spec.style
    }

    pub fn action_targets(&self, at: usize) -> action_targets::Params {
        action_targets::Params {
            envs: self.spec.envs as u32,
            driven: self.spec.action as u32,
            at: at as u32,
        }
    }

    /// `at` is the index of the step's first reward.
    pub fn end_episode(&self, at: usize) -> end_episode::Params {
        let (rules, model) = (self.task.rules(), &self.batch.model);
        end_episode::Params {
            envs: self.spec.envs as u32,
            at: at as u32,
            nq: model.nq() as u32,
            nv: model.nv() as u32,
            bodies: model.trees[0].bodies.len() as u32,
            head: body(model, "head"),
            pelvis: body(model, "pelvis"),
            right_foot: body(model, "right_foot"),
            left_foot: body(model, "left_foot"),
            measures: self.measures as u32,
            max_steps: rules.steps(),
            successes: self.task.successes(),
            min_head: rules.min_head_height,
            min_pelvis: rules.min_pelvis_height,
            min_body: rules.min_body_height,
            max_speed: MAX_SPEED,
        }
    }

    pub fn draw_starts(&self, moment: &StepContext) -> draw_starts::Params {
        let model = &self.batch.model;
        let width = model.nq() + model.nv();
        draw_starts::Params {
            envs: moment.envs,
            first: moment.first,
            seed: moment.seed,
            reset_counter: moment.step_counter,
            count: (self.task.start_states().len() / width) as u32,
            width: width as u32,
        }
    }

    /// `at` is the index of the first observation, `only` how the step ended for those to be observed,
    /// `1 << termination`.
    pub fn proprioception(&self, at: usize, only: u32) -> proprioception::Params {
        proprioception::Params {
            envs: self.spec.envs as u32,
            characters: 1,
            width: self.spec.observation.dim() as u32,
            at: at as u32,
            only,
        }
    }
}

fn body(model: &Model, name: &str) -> u32 {
    model.body(name).expect("a body of the humanoid") as u32
}
