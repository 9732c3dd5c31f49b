//! The task `box`: two fighters in an arena, each of which is an agent.
//!
//! [`Boxing`] are its choices, [`BoxingTask`] plays them, and [`evaluate`](evaluate::evaluate) lets two drivers
//! fight. A fighter that falls, or leaves the arena, has failed; the other's bout is then over, too. By a knock-down, a
//! fall soon after a blow, it is that one's [`SUCCESS`](crate::kernels::termination::SUCCESS) and worth nothing more;
//! else its value goes on, as it does for both when time is up. A bout is won by who remains alone; when time is up, by
//! who has knocked the other down more often or, that being equal, done more damage; when both fail at once, by nobody.
//! Damage is the impulse of a fighter's hands on the other's torso and head, friction included: of no other part, and
//! never of the ground.

pub mod bout;
mod choices;
pub mod command;
pub mod corners;
mod describe;
pub mod evaluate;

use super::batch::SimulatedWorld;
use super::recorded::{mean_action, start_states};
use super::task::{
    DT, EpisodeRules, GpuHumanoidTask, HumanoidTask, StepContext, StepOutcome, TaskBuffers,
    agent_bodies, agent_body, spec,
};
use crate::env::description::VectorPart;
use crate::env::spec::EnvSpec;
use crate::gpu::{Buffer, Gpu};
use crate::kernels::humanoid::boxing_state::state_dim;
use crate::kernels::humanoid::fighters::{FIGHTERS, Fighters};
use crate::kernels::humanoid::{
    boxing_observe, boxing_reward, joint_accelerations, place_fighters,
};
use crate::kernels::physics::smooth_dynamics::DynamicsLayout;
use crate::kernels::termination::TRUNCATED;
use crate::physics::model::Model;
use crate::physics::motion_library::MotionLibrary;
use crate::physics::scenes;
use crate::physics::simulator::Simulator;
pub use choices::Boxing;
use std::sync::Arc;

/// The task with the motion in which fighters begin.
pub struct BoxingTask {
    boxing: Boxing,
    model: Arc<Model>,
    start_states: Vec<f32>,
    rest_action: Vec<f32>,
    params: Params,
}

/// Parameters of its kernels, but for the moment.
#[derive(Clone, Copy)]
struct Params {
    place: place_fighters::Params,
    accelerations: joint_accelerations::Params,
    reward: boxing_reward::Params,
    observe: boxing_observe::Params,
}

/// The dimensions of so many bouts.
pub fn boxing_spec(envs: usize) -> EnvSpec {
    EnvSpec {
        bootstrap: BOOTSTRAP,
        ..spec(&scenes::boxing_match(), boxing_observe::DIM, envs)
    }
}

/// Ends after which the value goes on.
const BOOTSTRAP: u32 = 1 << TRUNCATED;

impl BoxingTask {
    /// The task, with start states that depend on `seed`, of a library of the humanoid alone.
    pub fn new(boxing: &Boxing, library: &MotionLibrary, seed: u32) -> BoxingTask {
        let model = Arc::new(scenes::boxing_match());
        BoxingTask {
            boxing: *boxing,
            start_states: start_states(library, seed),
            rest_action: mean_action(library),
            params: params(boxing, &model),
            model,
        }
    }

    /// The choices.
    pub fn boxing(&self) -> &Boxing {
        &self.boxing
    }
}

fn params(boxing: &Boxing, model: &Model) -> Params {
    let body = |name: &str| agent_body(model, name);
    let centre = |name: &str| model.bodies[body(name) as usize].com.z;
    let velocities_at = DynamicsLayout::new(model).velocities as u32;
    let bodies = agent_bodies(model) as u32;
    let (positions, dofs) = (
        (model.nq() / FIGHTERS) as u32,
        (model.nv() / FIGHTERS) as u32,
    );
    let [least, most] = boxing.start_distance;
    let reward = boxing_reward::Params {
        envs: 0,
        at: 0,
        velocities_at,
        bodies,
        head: body("head"),
        pelvis: body("pelvis"),
        torso: body("torso"),
        right_hand: body("right_hand"),
        left_hand: body("left_hand"),
        right_foot: body("right_foot"),
        left_foot: body("left_foot"),
        torso_up: centre("torso"),
        head_up: centre("head"),
        min_head: boxing.rules.min_head_height,
        min_pelvis: boxing.rules.min_pelvis_height,
        min_body: boxing.rules.min_body_height,
        fall_ends: u32::from(boxing.fall_ends),
        facing: u32::from(boxing.facing),
        additive: u32::from(boxing.additive),
        stagger_steps: boxing.stagger_steps(),
        blow_force: boxing.blow_force,
        clinch_steps: boxing.clinch_steps(),
        clinch: boxing.clinch_distance,
        arena: boxing.arena,
        near: boxing.near,
        speed: boxing.speed,
        dt: DT,
        damage_scale: boxing.damage_scale,
        damage_taken: 0.0,
        dense: 0.0,
        knockdown_bonus: boxing.knockdown_bonus,
        far_weight: boxing.far_weight,
        damage_weight: boxing.damage_weight,
        close_weight: boxing.close_weight,
        facing_weight: boxing.facing_weight,
        fall_weight: boxing.fall_weight,
        energy_weight: boxing.energy_weight,
        penalty_weight: boxing.penalty_weight,
    };
    Params {
        place: place_fighters::Params {
            envs: 0,
            first: 0,
            seed: 0,
            step_counter: 0,
            positions,
            dofs,
            arena: boxing.arena,
            least,
            most,
        },
        accelerations: joint_accelerations::Params {
            envs: 0,
            positions: model.nq() as u32,
            dofs,
            dt: DT,
        },
        reward,
        observe: boxing_observe::Params {
            envs: 0,
            at: 0,
            width: 0,
            only: 0,
            velocities_at,
            bodies,
            torso: reward.torso,
            head: reward.head,
            right_hand: reward.right_hand,
            left_hand: reward.left_hand,
            torso_up: reward.torso_up,
            head_up: reward.head_up,
            arena: boxing.arena,
        },
    }
}

impl Params {
    fn place(&self, moment: &StepContext) -> place_fighters::Params {
        place_fighters::Params {
            envs: moment.envs,
            first: moment.first,
            seed: moment.seed,
            step_counter: moment.step_counter,
            ..self.place
        }
    }

    /// `at` is the index of the step's first reward.
    fn reward(&self, boxing: &Boxing, moment: &StepContext, at: usize) -> boxing_reward::Params {
        boxing_reward::Params {
            envs: moment.envs,
            at: at as u32,
            damage_taken: boxing.damage_taken_at(moment.step_counter),
            dense: boxing.dense_at(moment.step_counter),
            ..self.reward
        }
    }

    fn fighters<'a>(&self, simulator: &'a Simulator) -> Fighters<'a> {
        Fighters {
            bodies: self.reward.fighter_bodies(),
            poses: &simulator.poses,
            velocities: &simulator.velocities,
        }
    }
}

impl HumanoidTask for BoxingTask {
    fn model(&self) -> &Arc<Model> {
        &self.model
    }

    fn rules(&self) -> &EpisodeRules {
        &self.boxing.rules
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
            // Of who has fallen or left the arena.
            "fall",
            "damage",
            "damage_from_behind",
            "knockdowns",
            "out",
            "engaged_steps",
            "clinches",
        ]
    }

    fn successes(&self) -> u32 {
        // Who leads has won, however the bout ends.
        0
    }

    fn bootstrap(&self) -> u32 {
        BOOTSTRAP
    }

    fn falls_end(&self) -> bool {
        false
    }

    fn observation(&self) -> usize {
        boxing_observe::DIM
    }

    fn describe(&self) -> Vec<VectorPart> {
        describe::parts(self.boxing.arena)
    }

    fn state_dim(&self) -> usize {
        state_dim(self.params.accelerations.dofs as usize)
    }

    fn force_pairs(&self) -> Vec<[usize; 2]> {
        let bodies = self.params.reward.fighter_bodies();
        let of = |fighter: usize, body: u32| fighter * bodies.count as usize + body as usize;
        let pairs = [0, 1].map(|me| {
            let hits = bodies.hands.map(|hand| {
                bodies
                    .targets
                    .map(|target| [of(me, hand), of(1 - me, target)])
            });
            hits.concat()
        });
        pairs.concat()
    }

    fn reward(
        &self,
        moment: &StepContext,
        simulator: &Simulator,
        world: &SimulatedWorld,
        state: &mut [f32],
        outcomes: &mut [StepOutcome],
        measures: &mut [f32],
    ) {
        joint_accelerations::update(&world.state.v, state, &self.params.accelerations);
        let touching = world.pair_forces(self.model.bodies.len());
        let fighters = self.params.fighters(simulator);
        let params = self.params.reward(&self.boxing, moment, 0);
        let steps = boxing_reward::step(&fighters, touching, state, measures, &params);
        for (outcome, step) in outcomes.iter_mut().zip(steps) {
            *outcome = StepOutcome {
                reward: step.reward,
                end: step.end,
                group: step.group,
            };
        }
    }

    fn begin(&self, env: usize, moment: &StepContext, start: &mut [f32], state: &mut [f32]) {
        place_fighters::place(env, start, state, &self.params.place(moment));
    }

    fn observe(
        &self,
        agent: usize,
        simulator: &Simulator,
        _world: &SimulatedWorld,
        _state: &[f32],
        out: &mut [f32],
    ) {
        let fighters = self.params.fighters(simulator);
        boxing_observe::observe(&fighters, agent, self.boxing.arena, out);
    }

    fn on_gpu(&self, _: &Gpu) -> Box<dyn GpuHumanoidTask> {
        Box::new(GpuBoxing {
            boxing: self.boxing,
            params: self.params,
        })
    }
}

struct GpuBoxing {
    boxing: Boxing,
    params: Params,
}

impl GpuHumanoidTask for GpuBoxing {
    fn reward(
        &self,
        worlds: &TaskBuffers,
        reward: &Buffer<f32>,
        group: &Buffer<u32>,
        at: usize,
        moment: &StepContext,
    ) {
        let (gpu, batch) = (&worlds.gpu, &worlds.batch);
        let accelerations = joint_accelerations::Params {
            envs: moment.envs,
            ..self.params.accelerations
        };
        joint_accelerations::launch(gpu, &batch.state, &worlds.state, &accelerations);
        boxing_reward::launch(
            gpu,
            &batch.poses,
            &batch.dynamics,
            &batch.forces,
            &worlds.state,
            reward,
            &worlds.measures,
            &worlds.task_end,
            group,
            &self.params.reward(&self.boxing, moment, at),
        );
    }

    fn begin(&self, worlds: &TaskBuffers, moment: &StepContext) {
        place_fighters::launch(
            &worlds.gpu,
            &worlds.ended,
            &worlds.batch.starts,
            &worlds.state,
            &self.params.place(moment),
        );
    }

    fn observe(&self, worlds: &TaskBuffers, out: &Buffer<f32>, at: usize, width: usize, only: u32) {
        let params = boxing_observe::Params {
            envs: worlds.ended.len() as u32,
            at: at as u32,
            width: width as u32,
            only,
            ..self.params.observe
        };
        boxing_observe::launch(
            &worlds.gpu,
            &worlds.batch.poses,
            &worlds.batch.dynamics,
            &worlds.ended,
            out,
            &params,
        );
    }
}
