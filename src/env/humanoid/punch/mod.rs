//! The tasks `punch`, to go up to a box and topple it, and `joystick`, to do so while facing another way.
//!
//! [`Punch`] are the choices of both, [`PunchTask`] plays them, and [`evaluate`](evaluate::evaluate) judges a
//! policy.

mod choices;
mod describe;
pub mod evaluate;
mod steering;

use super::batch::SimulatedWorld;
use super::recorded::{mean_action, start_states};
use super::task::{
    EpisodeRules, GpuHumanoidTask, HumanoidTask, StepContext, StepOutcome, TaskBuffers,
};
use crate::env::description::VectorPart;
use crate::gpu::{Buffer, Gpu};
use crate::kernels::humanoid::punch_state::{FACING, HIT_STEPS, MOVING, PUNCH_STATE};
use crate::kernels::humanoid::{place_target, punch_observe, punch_reward};
use crate::kernels::physics::smooth_dynamics::DynamicsLayout;
use crate::kernels::termination::SUCCESS;
use crate::physics::model::Model;
use crate::physics::motion_library::MotionLibrary;
use crate::physics::scenes;
use crate::physics::simulator::{Simulator, SimulatorState};
pub use choices::{FarReward, Hit, Punch};
use glam::Vec2;
use std::sync::Arc;

/// The task with the motion in which it begins.
pub struct PunchTask {
    punch: Punch,
    model: Arc<Model>,
    start_states: Vec<f32>,
    rest_action: Vec<f32>,
    params: Params,
}

/// Parameters of its kernels, but for the moment.
#[derive(Clone, Copy)]
struct Params {
    place: place_target::Params,
    reward: punch_reward::Params,
    observe: punch_observe::Params,
}

impl PunchTask {
    /// The task, with start states that depend on `seed`, of a library of the humanoid alone. `joystick` says
    /// whether facing and moving are wanted apart.
    pub fn new(punch: &Punch, joystick: bool, library: &MotionLibrary, seed: u32) -> PunchTask {
        let model = Arc::new(scenes::humanoid_and_box());
        PunchTask {
            punch: *punch,
            start_states: with_target(&model, library.model(), &start_states(library, seed)),
            rest_action: mean_action(library),
            params: params(punch, joystick, &model),
            model,
        }
    }

    /// The choices.
    pub fn punch(&self) -> &Punch {
        &self.punch
    }

    /// Whether facing and moving are wanted apart.
    pub fn joystick(&self) -> bool {
        self.params.observe.joystick == 1
    }

    /// From the root to the target on the ground, m, of a world with the positions `q`.
    pub fn gap(&self, q: &[f32]) -> Vec2 {
        let target = self.params.place.target_q as usize;
        Vec2::from_slice(&q[target..]) - Vec2::from_slice(q)
    }

    /// Whether the target of a world with this state of the task has been hit.
    pub fn is_hit(&self, state: &[f32]) -> bool {
        state[HIT_STEPS] > 0.0
    }

    /// The direction in which the joystick of a world with this state points, a unit vector on the ground.
    pub fn wanted_direction(&self, state: &[f32]) -> Vec2 {
        Vec2::from_slice(&state[MOVING..])
    }
}

/// Start states of the humanoid, with the target where its model has it.
fn with_target(model: &Model, humanoid: &Model, states: &[f32]) -> Vec<f32> {
    let (nq, nv) = (humanoid.nq(), humanoid.nv());
    let still = vec![0.0; model.nv() - nv];
    let states = states.chunks_exact(nq + nv).flat_map(|state| {
        let (q, v) = state.split_at(nq);
        [q, &model.qpos0[nq..], v, &still].concat()
    });
    states.collect()
}

fn params(punch: &Punch, joystick: bool, model: &Model) -> Params {
    let body = |name: &str| model.body(name).expect("a body of the scene") as u32;
    let target = model.bodies[body("box") as usize].joints.start;
    let target = &model.joints[target];
    let velocities_at = DynamicsLayout::new(model).velocities as u32;
    Params {
        place: place_target::Params {
            envs: 0,
            first: 0,
            seed: 0,
            step_counter: 0,
            nq: model.nq() as u32,
            target_q: target.q as u32,
            target_v: target.v as u32,
            near_share: punch.near_share,
            near_least: punch.near_distance[0],
            near_most: punch.near_distance[1],
            near_bearing: punch.near_bearing,
            least: punch.distance[0],
            most: punch.distance[1],
            // Half its height, and a little more: on the ground, rounding would decide whether it touches.
            height: model.qpos0[target.q + 2] + 1e-3,
            facing_power: punch.facing_power,
        },
        reward: punch_reward::Params {
            envs: 0,
            at: 0,
            velocities_at,
            bodies: model.bodies.len() as u32,
            own_bodies: model.trees[0].bodies.len() as u32,
            right_hand: body("right_hand"),
            left_hand: body("left_hand"),
            joystick: u32::from(joystick),
            far: punch.far as u32,
            facing: u32::from(punch.facing),
            fist_only: u32::from(punch.hit == Hit::Fist),
            steps_after: punch.steps_after_hit(),
            speed: punch.speed,
            near: punch.near,
            far_weight: punch.far_weight,
            hand_speed: punch.hand_speed,
            fist_speed: punch.fist_speed,
        },
        observe: punch_observe::Params {
            envs: 0,
            at: 0,
            width: 0,
            only: 0,
            velocities_at,
            target_body: body("box"),
            joystick: u32::from(joystick),
        },
    }
}

impl Params {
    fn place(&self, moment: &StepContext) -> place_target::Params {
        place_target::Params {
            envs: moment.envs,
            first: moment.first,
            seed: moment.seed,
            step_counter: moment.step_counter,
            ..self.place
        }
    }
}

impl HumanoidTask for PunchTask {
    fn model(&self) -> &Arc<Model> {
        &self.model
    }

    fn rules(&self) -> &EpisodeRules {
        &self.punch.rules
    }

    fn start_states(&self) -> &[f32] {
        &self.start_states
    }

    fn rest_action(&self) -> Vec<f32> {
        self.rest_action.clone()
    }

    fn stat_names(&self) -> &'static [&'static str] {
        &[
            "episodes",
            "successes",
            "steps",
            "returns",
            "fall",
            "hit",
            "fist_hit",
            "far_steps",
            "facing_error_sum",
        ]
    }

    fn successes(&self) -> u32 {
        1 << SUCCESS
    }

    fn observation(&self) -> usize {
        punch_observe::dim(self.joystick())
    }

    fn describe(&self) -> Vec<VectorPart> {
        describe::parts(self.joystick())
    }

    fn state_dim(&self) -> usize {
        PUNCH_STATE
    }

    fn force_pairs(&self) -> Vec<[usize; 2]> {
        let target = self.params.observe.target_body as usize;
        let own = self.model.trees[0].bodies.clone();
        own.map(|body| [body, target]).collect()
    }

    fn reward(
        &self,
        _moment: &StepContext,
        simulator: &Simulator,
        world: &SimulatedWorld,
        state: &mut [f32],
        outcomes: &mut [StepOutcome],
        measures: &mut [f32],
    ) {
        let bodies = punch_reward::Bodies {
            poses: &simulator.poses,
            velocities: &simulator.velocities,
            touching: world.pair_forces(self.model.bodies.len()),
        };
        let (reward, end, group) =
            punch_reward::step(&bodies, state, measures, &self.params.reward);
        outcomes[0] = StepOutcome { reward, end, group };
    }

    fn begin(&self, env: usize, moment: &StepContext, start: &mut [f32], state: &mut [f32]) {
        place_target::place(env, start, state, &self.params.place(moment));
    }

    fn move_target(&self, at: [f32; 2], world: &mut SimulatorState, state: &mut [f32]) {
        place_target::stand_at(at, &mut world.q, &mut world.v, state, &self.params.place);
    }

    fn steer(&self, moving: Vec2, facing: Vec2, state: &mut [f32]) {
        state[MOVING..MOVING + 2].copy_from_slice(&moving.to_array());
        state[FACING..FACING + 2].copy_from_slice(&facing.to_array());
    }

    fn observe(
        &self,
        _agent: usize,
        simulator: &Simulator,
        _world: &SimulatedWorld,
        state: &[f32],
        out: &mut [f32],
    ) {
        let (poses, velocities) = (&simulator.poses, &simulator.velocities);
        punch_observe::observe(poses, velocities, state, out, &self.params.observe);
    }

    fn on_gpu(&self, _: &Gpu) -> Box<dyn GpuHumanoidTask> {
        Box::new(GpuPunch {
            params: self.params,
        })
    }
}

struct GpuPunch {
    params: Params,
}

impl GpuHumanoidTask for GpuPunch {
    fn reward(
        &self,
        worlds: &TaskBuffers,
        reward: &Buffer<f32>,
        group: &Buffer<u32>,
        at: usize,
        moment: &StepContext,
    ) {
        let params = punch_reward::Params {
            envs: moment.envs,
            at: at as u32,
            ..self.params.reward
        };
        punch_reward::launch(
            &worlds.gpu,
            &worlds.batch.poses,
            &worlds.batch.dynamics,
            &worlds.batch.forces,
            &worlds.state,
            reward,
            &worlds.measures,
            &worlds.task_end,
            group,
            &params,
        );
    }

    fn begin(&self, worlds: &TaskBuffers, moment: &StepContext) {
        place_target::launch(
            &worlds.gpu,
            &worlds.ended,
            &worlds.batch.starts,
            &worlds.state,
            &self.params.place(moment),
        );
    }

    fn observe(&self, worlds: &TaskBuffers, out: &Buffer<f32>, at: usize, width: usize, only: u32) {
        let params = punch_observe::Params {
            envs: worlds.ended.len() as u32,
            at: at as u32,
            width: width as u32,
            only,
            ..self.params.observe
        };
        punch_observe::launch(
            &worlds.gpu,
            &worlds.batch.poses,
            &worlds.batch.dynamics,
            &worlds.state,
            &worlds.ended,
            out,
            &params,
        );
    }
}
