//! Judges a controller on a fixed set of episodes, each run to its end.

use super::controller::Controller;
use crate::kernels::locomotion::locomotion_layout::{state_f32};
use crate::kernels::termination;
use crate::kernels::rng::{random4, uniform01};
use crate::motion::RATE;
use crate::motion::database::Database;
use crate::motion::features::FRAMES_PER_STEP;
use crate::env::locomotion::cpu::CpuLocomotion;
use crate::env::locomotion::{LEVELS, Setup, Task};
use anyhow::Result;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Seed of the evaluation episodes: the same for every controller.
const EPISODES_SEED: u32 = 0x4556_414c;
pub const SECONDS_A_STEP: f32 = FRAMES_PER_STEP as f32 / RATE;
/// A character has turned to a new target once it nears it this fast, m/s.
const NEARING: f32 = 0.5;
/// Steps to wait for that.
const PATIENCE: u32 = 50;
/// A character loiters that stays this near its target, m, for more than so many steps on end
/// without reaching it.
const LOITER_DISTANCE: f32 = 1.5;
const LOITER_STEPS: u32 = 25;

/// What an evaluation found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    pub episodes: usize,
    /// Share of episodes that reached their target.
    pub success: f64,
    /// Share of episodes that ran into an obstacle.
    pub collision: f64,
    /// Share of episodes that stayed within 1.5 m of the target for over 5 s on end without reaching
    /// it.
    pub loiter: f64,
    /// Over the successful episodes, s.
    pub time_to_target_mean_s: f64,
    pub time_to_target_p95_s: f64,
    /// Length walked over the straight line from start to arrival.
    pub path_ratio: f64,
    /// Length walked over time, m/s.
    pub mean_speed: f64,
    /// Over all episodes, s.
    pub episode_length_mean_s: f64,
    /// On the plane, after the target has suddenly moved: time until the character nears the new one
    /// at 0.5 m/s, s; 10 if it never does.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub turn_delay_mean_s: Option<f64>,
}

/// The evaluation episodes of a task on a level.
pub fn episodes(database: &Arc<Database>, task: Task, level: u32, episodes: usize) -> CpuLocomotion {
    let setup = Setup {
        task,
        envs: episodes,
        horizon: 1,
        seed: EPISODES_SEED,
        level,
    };
    CpuLocomotion::new(database.clone(), &setup, 0)
}

/// One step of all worlds under a controller.
pub fn advance(world: &mut CpuLocomotion, controller: &dyn Controller) -> Result<()> {
    let action = controller.act(&world.observation(), world.rules.task.width())?;
    world.play(&action);
    Ok(())
}

/// The hardest level, which reports are of if no other is named.
pub fn hardest(
    controller: &dyn Controller,
    database: &Arc<Database>,
    task: Task,
    count: usize,
) -> Result<Report> {
    evaluate(controller, database, task, LEVELS - 1, count)
}

/// Sums over episodes.
#[derive(Default)]
struct Found {
    /// Of the successful episodes.
    times: Vec<f64>,
    ratios: Vec<f64>,
    walked: f64,
    collisions: usize,
    loiterers: usize,
    steps: f64,
    delays: Vec<f64>,
}

/// One episode on the way.
#[derive(Clone, Copy)]
struct Episode {
    phase: Phase,
    /// Steps on end near the target.
    near: u32,
    loiters: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Phase {
    /// Under way to the episode's target.
    Reaching,
    /// Arrived, and sent to another target some steps ago.
    Turning {
        since: u32,
    },
    Done,
}

/// Runs `count` fixed episodes to their end, and on the plane after each arrival a change of target.
pub fn evaluate(
    controller: &dyn Controller,
    database: &Arc<Database>,
    task: Task,
    level: u32,
    count: usize,
) -> Result<Report> {
    let mut world = episodes(database, task, level, count);
    let just_reset = Episode {
        phase: Phase::Reaching,
        near: 0,
        loiters: false,
    };
    let mut running = vec![just_reset; count];
    let mut found = Found::default();
    for step in 1..=task.max_steps() + PATIENCE {
        let before = world.state_f32.clone();
        advance(&mut world, controller)?;
        for (env, episode) in running.iter_mut().enumerate() {
            match episode.phase {
                Phase::Reaching => found.reaching(&mut world, env, episode, step),
                Phase::Turning { since } => {
                    found.turning(&world, &before, env, episode, step - since)
                }
                Phase::Done => {}
            }
        }
        let left: Vec<usize> = (0..running.len())
            .filter(|&env| running[env].phase != Phase::Done)
            .collect();
        if left.is_empty() {
            break;
        }
        // What is over need not be played on.
        if left.len() <= running.len() / 2 {
            world.keep(&left);
            running = left.iter().map(|&env| running[env]).collect();
        }
    }
    Ok(found.report(task, count))
}

impl Found {
    /// A step of a character under way to its target.
    fn reaching(&mut self, world: &mut CpuLocomotion, env: usize, episode: &mut Episode, step: u32) {
        let task = world.rules.task;
        let near = distance(world, &world.state_f32, env) <= LOITER_DISTANCE;
        episode.near = if near { episode.near + 1 } else { 0 };
        let termination = world.termination[env];
        episode.loiters |= episode.near > LOITER_STEPS && termination != termination::SUCCESS;
        if termination == termination::RUNNING {
            return;
        }
        self.steps += f64::from(step);
        self.loiterers += usize::from(episode.loiters);
        self.collisions += usize::from(termination == termination::FAILED);
        episode.phase = Phase::Done;
        if termination == termination::SUCCESS {
            let path = world.field(state_f32::TRAVELLED, env);
            let straight = world.field(state_f32::X, env).hypot(world.field(state_f32::Z, env));
            self.times.push(f64::from(step as f32 * SECONDS_A_STEP));
            self.ratios.push(f64::from(path / straight));
            self.walked += f64::from(path);
            if let Task::Plane(_) = task {
                send_elsewhere(world, env);
                episode.phase = Phase::Turning { since: step };
            }
        }
    }

    /// A step of a character whose target has moved, `waited` steps ago.
    fn turning(
        &mut self,
        world: &CpuLocomotion,
        before: &[f32],
        env: usize,
        episode: &mut Episode,
        waited: u32,
    ) {
        let nearer = distance(world, before, env) - distance(world, &world.state_f32, env);
        if nearer / SECONDS_A_STEP >= NEARING || waited >= PATIENCE {
            self.delays.push(f64::from(waited as f32 * SECONDS_A_STEP));
            episode.phase = Phase::Done;
        }
    }

    fn report(mut self, task: Task, episodes: usize) -> Report {
        self.times.sort_by(f64::total_cmp);
        let p95 = (self.times.len() * 95).div_ceil(100).saturating_sub(1);
        let share = |count: usize| count as f64 / episodes as f64;
        Report {
            episodes,
            success: share(self.times.len()),
            collision: share(self.collisions),
            loiter: share(self.loiterers),
            time_to_target_mean_s: mean(&self.times),
            time_to_target_p95_s: self.times.get(p95).copied().unwrap_or(0.0),
            path_ratio: mean(&self.ratios),
            mean_speed: self.walked / self.times.iter().sum::<f64>().max(1e-9),
            episode_length_mean_s: self.steps * f64::from(SECONDS_A_STEP) / episodes as f64,
            turn_delay_mean_s: match task {
                Task::Plane(_) => Some(mean(&self.delays)),
                Task::Obstacles(_) => None,
            },
        }
    }
}

/// From a character to its target, m, in a state `real` of the world.
fn distance(world: &CpuLocomotion, state_f32: &[f32], env: usize) -> f32 {
    let at = |field: usize| state_f32[field * world.rules.envs + env];
    let x = at(state_f32::TARGET_X) - at(state_f32::X);
    x.hypot(at(state_f32::TARGET_Z) - at(state_f32::Z))
}

/// 0 of nothing, so that reports stay plain numbers.
fn mean(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |sum, value| sum + value) / values.len().max(1) as f64
}

/// Moves one character's target to a random place of the task's square, at least 2 m (or two fifths
/// of the square's half side) away, so that there is something to turn to. On the plane the square
/// lies around the character; obstacles have their own, and the target stands clear of them.
pub fn send_elsewhere(world: &mut CpuLocomotion, env: usize) {
    const STREAM: u32 = 0x5455_524e;
    let (envs, half_side) = (world.rules.envs, world.rules.task.half_side(LEVELS - 1));
    let at = [state_f32::X, state_f32::Z].map(|field| world.field(field, env));
    let centre = match world.rules.task {
        Task::Plane(_) => at,
        Task::Obstacles(_) => [0.0; 2],
    };
    // Keyed by where it stands, which does not change when others leave the batch.
    let bits = (0..).map(|draw| random4(EPISODES_SEED, at[0].to_bits(), draw, STREAM));
    let places = bits.map(|bits| {
        let [x, z] = [bits[0], bits[1]].map(|b| (2.0 * uniform01(b) - 1.0) * half_side);
        [centre[0] + x, centre[1] + z]
    });
    let least = (half_side * 0.4).min(2.0);
    let far = |place: &[f32; 2]| (place[0] - at[0]).hypot(place[1] - at[1]) >= least;
    let place = places
        .take(64)
        .find(|place| far(place) && !world.blocked(env, *place))
        .unwrap_or(centre.map(|c| c + half_side));
    world.state_f32[state_f32::TARGET_X * envs + env] = place[0];
    world.state_f32[state_f32::TARGET_Z * envs + env] = place[1];
}
