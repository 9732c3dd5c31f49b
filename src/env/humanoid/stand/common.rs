//! What environments on both devices need to know: the model, the kernels' parameters.

use super::task::{DT, KEY_BODIES, Stand, spec};
use crate::env::humanoid::action::action_scale;
use crate::env::humanoid::batch::{MAX_SPEED, SimulatorBatchConfig};
use crate::env::humanoid::starts::{START_STATES, start_states};
use crate::env::spec::EnvSpec;
use crate::kernels::humanoid::{action_targets, draw_starts, random_pushes, stand_reward};
use crate::kernels::physics::proprioception;
use crate::kernels::rng::{index_below, random4};
use crate::physics::scenes;
use crate::physics::simulator::SolverOptions;
use std::ops::Range;
use std::sync::Arc;

/// Steps of which one has a push, and of which first ones it may be: pushes are from 30 to 60 steps
/// apart, one to two seconds.
const PUSH_INTERVAL: u32 = 45;
const PUSH_JITTER: u32 = 15;

/// Stream of the lengths of first episodes.
const STREAM: u32 = 0x4147_4553;

pub struct Common {
    pub stand: Stand,
    pub spec: EnvSpec,
    pub batch: SimulatorBatchConfig,
    /// Number of the first environment in the whole batch.
    pub first: usize,
    /// `[2][nu]`, see [`action_scale`].
    pub action_scale: Vec<f32>,
    /// `[START_STATES][nq + nv]`
    pub start_states: Vec<f32>,
    /// The argument of [`proprioception`]: one character and its key bodies.
    pub characters: Vec<u32>,
    /// Steps of the run so far: the random numbers' counter.
    pub step_counter: u32,
}

impl Common {
    pub fn new(stand: &Stand, envs: Range<usize>, seed: u32) -> Common {
        let model = Arc::new(scenes::humanoid());
        let body = |name: &str| model.body(name).expect("a body of the humanoid");
        let keys = KEY_BODIES.map(|name| body(name) as u32);
        let feet = ["right_foot", "left_foot"].map(body);
        let spread = stand.start_spread();
        Common {
            stand: *stand,
            spec: spec(envs.len()),
            first: envs.start,
            action_scale: action_scale(&model),
            start_states: start_states(&model, &feet, &spread, seed, START_STATES),
            characters: [&[keys.len() as u32, 0], &keys[..]].concat(),
            step_counter: 0,
            batch: SimulatorBatchConfig {
                envs: envs.len(),
                options: SolverOptions::fast(&model),
                seed,
                force_pairs: Vec::new(),
                model,
            },
        }
    }

    /// Steps after which the first episode of each environment is truncated, `[envs]`.
    pub fn staggered_limits(&self) -> Vec<f32> {
        let steps = self.stand.episode_steps();
        let numbers = self.first..self.first + self.spec.envs;
        let limits = numbers.map(|env| {
            let [bits, ..] = random4(self.batch.seed, env as u32, 0, STREAM);
            steps - index_below(bits, steps)
        });
        limits.map(|steps| steps as f32).collect()
    }

    pub fn action_targets(&self, at: usize) -> action_targets::Params {
        action_targets::Params {
            envs: self.spec.envs as u32,
            driven: self.spec.action as u32,
            at: at as u32,
        }
    }

    pub fn random_pushes(&self) -> random_pushes::Params {
        random_pushes::Params {
            envs: self.spec.envs as u32,
            first: self.first as u32,
            seed: self.batch.seed,
            step_counter: self.step_counter,
            interval: PUSH_INTERVAL,
            jitter: PUSH_JITTER,
            body: self.body("torso"),
            min_force: self.stand.min_push / DT,
            max_force: self.stand.max_push / DT,
        }
    }

    /// `at` is the index of the step's first reward.
    pub fn stand_reward(&self, at: usize) -> stand_reward::Params {
        let (stand, model) = (&self.stand, &self.batch.model);
        stand_reward::Params {
            envs: self.spec.envs as u32,
            at: at as u32,
            nq: model.nq() as u32,
            nv: model.nv() as u32,
            bodies: model.bodies.len() as u32,
            head: self.body("head"),
            pelvis: self.body("pelvis"),
            torso: self.body("torso"),
            right_foot: self.body("right_foot"),
            left_foot: self.body("left_foot"),
            max_steps: stand.episode_steps(),
            min_head: stand.min_head_height,
            min_pelvis: stand.min_pelvis_height,
            min_body: stand.min_body_height,
            max_speed: MAX_SPEED,
            alive_reward: stand.alive_reward,
            upright_reward: stand.upright_reward,
            stillness_reward: stand.stillness_reward,
        }
    }

    /// Each reset has another counter: zero that of the opening, then one more than the step's.
    pub fn draw_starts(&self, reset_counter: u32) -> draw_starts::Params {
        let model = &self.batch.model;
        draw_starts::Params {
            envs: self.spec.envs as u32,
            first: self.first as u32,
            seed: self.batch.seed,
            reset_counter,
            count: START_STATES as u32,
            width: (model.nq() + model.nv()) as u32,
        }
    }

    /// `at` is the index of the first observation, `only` how the step ended for those to be observed.
    pub fn proprioception(&self, at: usize, only: u32) -> proprioception::Params {
        proprioception::Params {
            envs: self.spec.envs as u32,
            characters: 1,
            width: self.spec.observation.vector as u32,
            at: at as u32,
            only,
        }
    }

    fn body(&self, name: &str) -> u32 {
        self.batch.model.body(name).expect("a body of the humanoid") as u32
    }
}
