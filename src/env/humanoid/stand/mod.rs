//! The task `stand`: stay upright for ten seconds from a random pose near standing, while pushed.
//!
//! [`Stand`] are its choices, [`StandTask`] plays them, and [`evaluate`](evaluate::evaluate) judges a
//! policy.

mod choices;
pub mod evaluate;

use super::action::rest_action;
use super::batch::SimulatedWorld;
use super::starts::{START_STATES, start_states};
use super::task::{
    DT, EpisodeRules, GpuHumanoidTask, HumanoidTask, StepContext, StepOutcome, TaskBuffers,
};
use crate::gpu::{Buffer, Gpu};
use crate::kernels::humanoid::{random_pushes, stand_reward};
use crate::physics::model::Model;
use crate::physics::scenes;
use crate::physics::simulator::Simulator;
pub use choices::Stand;
use glam::Vec2;
use std::sync::Arc;

/// Steps of which one has a push, and of which first ones it may be: pushes are from 30 to 60 steps
/// apart, one to two seconds.
const PUSH_INTERVAL: u32 = 45;
const PUSH_JITTER: u32 = 15;

/// The task with its start states.
///
/// ```
/// use footwork::env::Transition;
/// use footwork::env::humanoid::stand::{Stand, StandTask};
/// use footwork::env::humanoid::task::open;
/// use footwork::gpu::{Array, Device};
/// use std::sync::Arc;
///
/// let task = Arc::new(StandTask::new(&Stand::default(), 1));
/// let mut envs = open(&Device::Cpu, task, 0..8, 1)?;
/// let (spec, rest) = (*envs.spec(), envs.rest_action());
/// let action = Array::Host(rest.repeat(spec.rows()));
/// let mut observation = Array::zeroed(&Device::Cpu, spec.rows() * spec.observation.dim());
/// let mut final_observation = observation.clone();
/// let mut reward = Array::zeroed(&Device::Cpu, spec.rows());
/// let mut style_reward = reward.clone();
/// let mut termination = Array::zeroed(&Device::Cpu, spec.rows());
/// let mut group = termination.clone();
/// for _ in 0..5 {
///     let out = Transition {
///         step: 0,
///         reward: &mut reward,
///         style_reward: &mut style_reward,
///         termination: &mut termination,
///         group: &mut group,
///         final_observation: &mut final_observation,
///     };
///     envs.step(&action, 0, out);
/// }
/// envs.observe(&mut observation, 0);
/// assert!(reward.host().iter().all(|&reward| reward > 0.0));
/// # Ok::<(), anyhow::Error>(())
/// ```
pub struct StandTask {
    stand: Stand,
    model: Arc<Model>,
    start_states: Vec<f32>,
    params: Params,
}

/// Parameters of its kernels, but for the moment.
#[derive(Clone, Copy)]
struct Params {
    pushes: random_pushes::Params,
    reward: stand_reward::Params,
}

impl StandTask {
    /// The task, with start states that depend on `seed`.
    pub fn new(stand: &Stand, seed: u32) -> StandTask {
        let model = Arc::new(scenes::humanoid());
        let body = |name: &str| model.body(name).expect("a body of the humanoid");
        let feet = ["right_foot", "left_foot"].map(body);
        let spread = stand.start_spread();
        let torso = body("torso") as u32;
        StandTask {
            stand: *stand,
            start_states: start_states(&model, &feet, &spread, seed, START_STATES),
            params: Params {
                pushes: random_pushes::Params {
                    envs: 0,
                    first: 0,
                    seed: 0,
                    step_counter: 0,
                    interval: PUSH_INTERVAL,
                    jitter: PUSH_JITTER,
                    body: torso,
                    min_force: stand.min_push / DT,
                    max_force: stand.max_push / DT,
                },
                reward: stand_reward::Params {
                    envs: 0,
                    at: 0,
                    nq: model.nq() as u32,
                    nv: model.nv() as u32,
                    torso,
                    alive_reward: stand.alive_reward,
                    upright_reward: stand.upright_reward,
                    stillness_reward: stand.stillness_reward,
                },
            },
            model,
        }
    }
}

impl Params {
    fn pushes(&self, moment: &StepContext) -> random_pushes::Params {
        random_pushes::Params {
            envs: moment.envs,
            first: moment.first,
            seed: moment.seed,
            step_counter: moment.step_counter,
            ..self.pushes
        }
    }
}

impl HumanoidTask for StandTask {
    fn model(&self) -> &Arc<Model> {
        &self.model
    }

    fn rules(&self) -> &EpisodeRules {
        &self.stand.rules
    }

    fn start_states(&self) -> &[f32] {
        &self.start_states
    }

    fn rest_action(&self) -> Vec<f32> {
        rest_action(&self.model, &self.model.qpos0)
    }

    fn stat_names(&self) -> &'static [&'static str] {
        &[
            "episodes",
            "successes",
            "steps",
            "returns",
            "fall",
            "uprightness",
        ]
    }

    fn act(&self, env: usize, moment: &StepContext, world: &mut SimulatedWorld) {
        let pushes = self.params.pushes(moment);
        let force = &mut world.external_forces[pushes.body as usize].linear;
        *force += Vec2::from(random_pushes::push(env, &pushes)).extend(0.0);
    }

    fn reward(
        &self,
        _moment: &StepContext,
        simulator: &Simulator,
        world: &SimulatedWorld,
        _state: &mut [f32],
        outcomes: &mut [StepOutcome],
        measures: &mut [f32],
    ) {
        let params = &self.params.reward;
        let torso = simulator.poses[params.torso as usize].rotation;
        measures[0] = stand_reward::uprightness(torso);
        outcomes[0].reward = stand_reward::reward(measures[0], &world.state.v, params);
    }

    fn on_gpu(&self, _: &Gpu) -> Box<dyn GpuHumanoidTask> {
        Box::new(GpuStand {
            params: self.params,
        })
    }
}

struct GpuStand {
    params: Params,
}

impl GpuHumanoidTask for GpuStand {
    fn act(&self, worlds: &TaskBuffers, moment: &StepContext) {
        let pushes = self.params.pushes(moment);
        random_pushes::launch(&worlds.gpu, &worlds.batch.external_forces, &pushes);
    }

    fn reward(
        &self,
        worlds: &TaskBuffers,
        reward: &Buffer<f32>,
        _group: &Buffer<u32>,
        at: usize,
        moment: &StepContext,
    ) {
        let params = stand_reward::Params {
            envs: moment.envs,
            at: at as u32,
            ..self.params.reward
        };
        let batch = &worlds.batch;
        stand_reward::launch(
            &worlds.gpu,
            &batch.state,
            &batch.poses,
            reward,
            &worlds.measures,
            &params,
        );
    }
}
