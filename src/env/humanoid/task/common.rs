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
use crate::physics::model::{Body, KinematicTree, Model};
use crate::physics::simulator::SolverOptions;
use std::ops::Range;
use std::sync::Arc;

/// Bodies whose positions are observed.
pub const KEY_BODIES: [&str; 4] = ["right_hand", "left_hand", "right_foot", "left_foot"];

/// Stream of the lengths of first episodes.
const STREAM: u32 = 0x4147_4553;

/// The dimensions of `envs` environments of a task that adds so many numbers to the observation of a
/// body.
pub fn spec(model: &Model, task_observation: usize, envs: usize) -> EnvSpec {
    let body = proprioception::width(model, 0, KEY_BODIES.len());
    let agents = agents(model);
    EnvSpec {
        envs,
        agents,
        observation: ObservationSpec {
            vector: body + task_observation,
            grid: None,
        },
        style: body,
        action: model.nu() / agents,
        dt: DT,
        bootstrap: 1 << TRUNCATED | 1 << SUCCESS,
        bootstraps_often: true,
    }
}

/// Agents of a world: the trees of its model that have drives. They come first, and are all alike.
pub fn agents(model: &Model) -> usize {
    let driven = |tree: &&KinematicTree| {
        let mut dofs = model.dofs[tree.dofs.clone()].iter();
        dofs.any(|dof| dof.drive.is_some())
    };
    model.trees.iter().filter(driven).count()
}

/// Index of the first agent's body of this name, whatever prefix its part of the world has; the other agents'
/// follow at distances of [`agent_bodies`].
pub fn agent_body(model: &Model, name: &str) -> u32 {
    let is_it = |body: &Body| body.name.rsplit('/').next() == Some(name);
    let found = model.bodies.iter().position(is_it);
    found.expect("a body of the humanoid") as u32
}

/// Bodies of an agent.
pub fn agent_bodies(model: &Model) -> usize {
    model.trees[0].bodies.len()
}

/// The argument of [`proprioception`]: how many key bodies there are, then of every agent its tree and its key
/// bodies.
pub fn characters(model: &Model) -> Vec<u32> {
    let keys = KEY_BODIES.map(|name| agent_body(model, name));
    let bodies = agent_bodies(model) as u32;
    let own = |agent: u32| {
        [agent]
            .into_iter()
            .chain(keys.map(|key| key + agent * bodies))
    };
    let all = (0..agents(model) as u32).flat_map(own);
    [keys.len() as u32].into_iter().chain(all).collect()
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
            spec: EnvSpec {
                bootstrap: task.bootstrap(),
                ..spec(&model, task.observation(), envs.len())
            },
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
            driven: self.batch.model.nu() as u32,
            at: at as u32,
        }
    }

    /// `at` is the index of the step's first reward.
    pub fn end_episode(&self, at: usize) -> end_episode::Params {
        let (rules, model) = (self.task.rules(), &self.batch.model);
        end_episode::Params {
            envs: self.spec.envs as u32,
            agents: self.spec.agents as u32,
            at: at as u32,
            nq: model.nq() as u32,
            nv: model.nv() as u32,
            bodies: agent_bodies(model) as u32,
            head: agent_body(model, "head"),
            pelvis: agent_body(model, "pelvis"),
            right_foot: agent_body(model, "right_foot"),
            left_foot: agent_body(model, "left_foot"),
            measures: self.measures as u32,
            max_steps: rules.steps(),
            successes: self.task.successes(),
            falls_end: u32::from(self.task.falls_end()),
            min_head: rules.min_head_height,
            min_pelvis: rules.min_pelvis_height,
            min_body: rules.min_body_height,
            max_speed: MAX_SPEED,
        }
    }

    pub fn draw_starts(&self, moment: &StepContext) -> draw_starts::Params {
        let (model, agents) = (&self.batch.model, self.spec.agents);
        let (positions, velocities) = (model.nq() / agents, model.nv() / agents);
        let width = positions + velocities;
        draw_starts::Params {
            envs: moment.envs,
            agents: agents as u32,
            first: moment.first,
            seed: moment.seed,
            reset_counter: moment.step_counter,
            count: (self.task.start_states().len() / width) as u32,
            positions: positions as u32,
            velocities: velocities as u32,
        }
    }

    /// `at` is the index of the first observation, `only` how the step ended for those to be observed,
    /// `1 << termination`.
    pub fn proprioception(&self, at: usize, only: u32) -> proprioception::Params {
        proprioception::Params {
            envs: self.spec.envs as u32,
            characters: self.spec.agents as u32,
            width: self.spec.observation.dim() as u32,
            at: at as u32,
            only,
        }
    }
}
