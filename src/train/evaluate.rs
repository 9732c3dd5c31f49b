//! Judges a controller on a fixed set of episodes, each run to its end.

use super::checkpoint::Checkpoint;
use crate::kernels::layout::{OBSERVATION, end, real};
use crate::kernels::rng::{random4, uniform01};
use crate::motion::RATE;
use crate::motion::database::Database;
use crate::motion::features::{AHEAD, PLAYED, POSE, TRAJECTORY};
use crate::motion::frame::to_local;
use crate::ppo::policy::{Policy, Shape};
use crate::tensors;
use crate::world::cpu::CpuWorld;
use crate::world::{Plane, World};
use anyhow::Result;
use burn::tensor::Device;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Seed of the evaluation episodes: the same for every controller.
const EPISODES_SEED: u32 = 0x4556_414c;
const SECONDS_A_STEP: f32 = PLAYED as f32 / RATE;
/// A character has turned to a new target once it nears it this fast, m/s.
const NEARING: f32 = 0.5;
/// Steps to wait for that.
const PATIENCE: u32 = 50;

/// Anything that asks for trajectories.
pub trait Controller {
    /// Normalised actions `[envs][TRAJECTORY]` for observations `[envs][OBSERVATION]`.
    fn act(&self, observation: &[f32]) -> Result<Vec<f32>>;
}

/// A trained policy's mean, without exploration.
pub struct Trained {
    policy: Policy,
    device: Device,
}

impl Trained {
    pub fn new(hidden: &[usize], parameters: &[f32]) -> Self {
        let device = Device::flex();
        Trained {
            policy: Shape::new(hidden).cut(&tensors::vector(parameters, &device)),
            device,
        }
    }
}

impl From<&Checkpoint> for Trained {
    fn from(checkpoint: &Checkpoint) -> Self {
        Trained::new(&checkpoint.header.hidden, &checkpoint.parameters)
    }
}

impl Controller for Trained {
    fn act(&self, observation: &[f32]) -> Result<Vec<f32>> {
        let shape = [observation.len() / OBSERVATION, OBSERVATION];
        tensors::read(
            self.policy
                .mean(tensors::upload(observation.to_vec(), shape, &self.device)),
        )
    }
}

/// Scripted motion matching: asks for a straight walk to the target at one speed.
pub struct Scripted<'a> {
    pub database: &'a Database,
    /// m/s
    pub speed: f32,
}

impl Controller for Scripted<'_> {
    fn act(&self, observation: &[f32]) -> Result<Vec<f32>> {
        let normal = &self.database.normalisation;
        let mut action = Vec::with_capacity(observation.len() / OBSERVATION * TRAJECTORY);
        for row in observation.chunks_exact(OBSERVATION) {
            // The goal's scale does not matter for its direction.
            let goal = [row[POSE], row[POSE + 1]];
            let length = goal[0].hypot(goal[1]).max(1e-6);
            let direction = goal.map(|g| g / length);
            for (k, ahead) in AHEAD.iter().enumerate() {
                let far = self.speed * *ahead as f32 / RATE;
                let asked = [
                    direction[0] * far,
                    direction[1] * far,
                    direction[0],
                    direction[1],
                ];
                for (i, value) in asked.into_iter().enumerate() {
                    let at = POSE + 4 * k + i;
                    action.push((value - normal.mean[at]) * normal.scale[at]);
                }
            }
        }
        Ok(action)
    }
}

/// What an evaluation found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    pub episodes: usize,
    /// Share of episodes that reached their target.
    pub success: f64,
    /// Over the successful episodes, s.
    pub time_to_target_mean_s: f64,
    pub time_to_target_p95_s: f64,
    /// Length walked over the straight line from start to arrival.
    pub path_ratio: f64,
    /// Length walked over time, m/s.
    pub mean_speed: f64,
    /// After the target has suddenly moved: time until the character nears the new one at
    /// 0.5 m/s, s; 10 if it never does.
    pub turn_delay_mean_s: f64,
}

/// One episode's walk, for pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Walk {
    /// Root on the ground after every step, `[x, z]`, m.
    pub points: Vec<[f32; 2]>,
    pub target: [f32; 2],
    pub reached: bool,
}

#[derive(Clone, Copy)]
enum Phase {
    /// Under way to the episode's target.
    Reaching,
    /// Arrived, and sent to another target some steps ago.
    Turning {
        since: u32,
    },
    Done,
}

/// Runs `episodes` fixed episodes to their end, and after each arrival a change of target.
pub fn evaluate(
    controller: &dyn Controller,
    database: &Arc<Database>,
    task: Plane,
    episodes: usize,
) -> Result<Report> {
    let mut world = CpuWorld::fresh(database.clone(), task, episodes, EPISODES_SEED);
    let mut phases = vec![Phase::Reaching; episodes];
    let (mut times, mut ratios, mut walked, mut delays) = (vec![], vec![], 0.0, vec![]);
    for step in 1..=task.max_steps + PATIENCE {
        let before = world.real.clone();
        let observation = tensors::read(world.observe())?;
        world.play(&controller.act(&observation)?);
        for (env, phase) in phases.iter_mut().enumerate() {
            let field = |of: &[f32], field: usize| of[field * episodes + env];
            *phase = match *phase {
                Phase::Reaching if world.ended[env] == end::REACHED => {
                    let straight = field(&world.real, real::X).hypot(field(&world.real, real::Z));
                    let path = field(&world.real, real::TRAVELLED);
                    times.push(f64::from(step as f32 * SECONDS_A_STEP));
                    ratios.push(f64::from(path / straight));
                    walked += f64::from(path);
                    send_elsewhere(&mut world, env, task);
                    Phase::Turning { since: step }
                }
                Phase::Reaching if step >= task.max_steps => Phase::Done,
                Phase::Turning { since } => {
                    let distance = |of: &[f32]| {
                        let x = field(of, real::TARGET_X) - field(of, real::X);
                        x.hypot(field(of, real::TARGET_Z) - field(of, real::Z))
                    };
                    let nearing = (distance(&before) - distance(&world.real)) / SECONDS_A_STEP;
                    if nearing >= NEARING || step - since >= PATIENCE {
                        delays.push(f64::from((step - since) as f32 * SECONDS_A_STEP));
                        Phase::Done
                    } else {
                        *phase
                    }
                }
                unchanged => unchanged,
            };
        }
        if phases.iter().all(|phase| matches!(phase, Phase::Done)) {
            break;
        }
    }
    times.sort_by(f64::total_cmp);
    let p95 = times
        .len()
        .saturating_mul(95)
        .div_ceil(100)
        .saturating_sub(1);
    Ok(Report {
        episodes,
        success: times.len() as f64 / episodes as f64,
        time_to_target_mean_s: mean(&times),
        time_to_target_p95_s: times.get(p95).copied().unwrap_or(0.0),
        path_ratio: mean(&ratios),
        mean_speed: walked / times.iter().sum::<f64>().max(1e-9),
        turn_delay_mean_s: mean(&delays),
    })
}

/// 0 of nothing, so that reports stay plain numbers.
fn mean(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |sum, value| sum + value) / values.len().max(1) as f64
}

/// Moves one character's target to a random place of the task's square around it, at least 2 m
/// (or two fifths of the square's half side) away, so that there is something to turn to.
fn send_elsewhere(world: &mut CpuWorld, env: usize, task: Plane) {
    const STREAM: u32 = 0x5455_524e;
    let envs = world.envs();
    let bits = (0..).map(|draw| random4(EPISODES_SEED, env as u32, draw, STREAM));
    let places =
        bits.map(|bits| [bits[0], bits[1]].map(|b| (2.0 * uniform01(b) - 1.0) * task.half_side));
    let least = (task.half_side * 0.4).min(2.0);
    let place = places
        .take(64)
        .find(|[x, z]| x.hypot(*z) >= least)
        .unwrap_or([task.half_side; 2]);
    world.real[real::TARGET_X * envs + env] = world.real[real::X * envs + env] + place[0];
    world.real[real::TARGET_Z * envs + env] = world.real[real::Z * envs + env] + place[1];
}

/// The walks of the first `episodes` evaluation episodes, turned so that each starts facing +z.
pub fn walks(
    controller: &dyn Controller,
    database: &Arc<Database>,
    task: Plane,
    episodes: usize,
) -> Result<Vec<Walk>> {
    let mut world = CpuWorld::fresh(database.clone(), task, episodes, EPISODES_SEED);
    let field = |world: &CpuWorld, field: usize, env: usize| world.real[field * episodes + env];
    let headings: Vec<[f32; 2]> = (0..episodes)
        .map(|env| {
            [
                field(&world, real::HEADING_X, env),
                field(&world, real::HEADING_Z, env),
            ]
        })
        .collect();
    let at = |world: &CpuWorld, env: usize, x: usize, z: usize| {
        to_local([field(world, x, env), field(world, z, env)], headings[env])
    };
    let mut walks: Vec<Walk> = (0..episodes)
        .map(|env| Walk {
            points: vec![[0.0; 2]],
            target: at(&world, env, real::TARGET_X, real::TARGET_Z),
            reached: false,
        })
        .collect();
    for _ in 0..task.max_steps {
        let observation = tensors::read(world.observe())?;
        world.play(&controller.act(&observation)?);
        for (env, walk) in walks
            .iter_mut()
            .enumerate()
            .filter(|(_, walk)| !walk.reached)
        {
            walk.points.push(at(&world, env, real::X, real::Z));
            walk.reached = world.ended[env] == end::REACHED;
        }
        if walks.iter().all(|walk| walk.reached) {
            break;
        }
    }
    Ok(walks)
}

/// Seconds of a walk.
pub fn seconds(walk: &Walk) -> f32 {
    (walk.points.len() - 1) as f32 * SECONDS_A_STEP
}
