//! Evaluates a controller of a motion-matching task on fixed episodes, each run to its end.

use super::controller::Controller;
use super::evaluation::Evaluation;
use crate::env::locomotion::cpu::CpuLocomotion;
use crate::env::locomotion::{EnvConfig, LEVELS, LocomotionTask, STEP_S};
use crate::kernels::locomotion::locomotion_layout::state_f32;
use crate::kernels::rng::{random4, uniform01};
use crate::kernels::termination;
use crate::matching::MotionMatcher;
use anyhow::Result;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Seed of the evaluation episodes: the same for every controller.
const EPISODES_SEED: u32 = 0x4556_414c;
/// A character has turned to a new target once it nears it this fast, m/s.
const NEARING: f32 = 0.5;
/// Steps to wait for that.
const PATIENCE: u32 = 50;
/// A character loiters that stays this near its target, m, for more than so many steps on end
/// without reaching it.
const LOITER_DISTANCE: f32 = 1.5;
const LOITER_STEPS: u32 = 25;

/// What the evaluation of a controller found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LocomotionReport {
    /// Episodes played.
    pub episodes: usize,
    /// Fraction of episodes that reached their target.
    pub success: f64,
    /// Fraction of episodes that ran into an obstacle.
    pub collision: f64,
    /// Fraction of episodes that stayed within 1.5 m of the target for over 5 s on end without reaching
    /// it.
    pub loiter: f64,
    /// Mean time to the target over the successful episodes, s.
    pub time_to_target_mean_s: f64,
    /// 95th percentile of the time to the target over the successful episodes, s.
    pub time_to_target_p95_s: f64,
    /// Length walked over the straight line from start to arrival.
    pub path_ratio: f64,
    /// Length walked over time, m/s.
    pub mean_speed: f64,
    /// Over all episodes, s.
    pub episode_length_mean_s: f64,
    /// Where there is no arena, after the target has suddenly moved: time until the character nears the new one
    /// at 0.5 m/s, s; 10 if it never does.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub turn_delay_mean_s: Option<f64>,
}

impl LocomotionReport {
    /// The report in the trainer's terms.
    pub fn evaluation(&self) -> Evaluation {
        let always = [
            ("collision", self.collision),
            ("loiter", self.loiter),
            ("time_to_target_mean_s", self.time_to_target_mean_s),
            ("time_to_target_p95_s", self.time_to_target_p95_s),
            ("path_ratio", self.path_ratio),
            ("mean_speed", self.mean_speed),
            ("episode_length_mean_s", self.episode_length_mean_s),
        ];
        let delay = self
            .turn_delay_mean_s
            .map(|delay| ("turn_delay_mean_s", delay));
        Evaluation {
            episodes: self.episodes,
            success: self.success,
            measures: always.into_iter().chain(delay).collect(),
            ..Evaluation::default()
        }
    }
}

/// The first `count` evaluation episodes of a task on a level.
pub fn episodes(
    matcher: &Arc<MotionMatcher>,
    task: LocomotionTask,
    level: u32,
    count: usize,
) -> CpuLocomotion {
    let config = EnvConfig {
        task,
        envs: count,
        seed: EPISODES_SEED,
        level,
    };
    CpuLocomotion::new(matcher.clone(), &config)
}

/// Plays one step of all environments under a controller.
///
/// # Errors
/// See [`Controller::act`].
pub fn advance(envs: &mut CpuLocomotion, controller: &dyn Controller) -> Result<()> {
    let action = controller.act(&envs.observation(), envs.params.observation_dim())?;
    envs.step_without_reset(&action);
    Ok(())
}

/// Evaluates a controller on the hardest level.
///
/// # Errors
/// See [`Controller::act`].
pub fn hardest(
    controller: &dyn Controller,
    matcher: &Arc<MotionMatcher>,
    task: LocomotionTask,
    count: usize,
) -> Result<LocomotionReport> {
    evaluate(controller, matcher, task, LEVELS - 1, count)
}

/// Sums over episodes.
#[derive(Default)]
struct Found {
    /// Times of the successful episodes, s, and their path ratios.
    times: Vec<f64>,
    ratios: Vec<f64>,
    walked: f64,
    collisions: usize,
    loiterers: usize,
    steps: f64,
    delays: Vec<f64>,
}

/// An episode under way.
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

/// Evaluates a controller on `count` fixed episodes, and where there is no arena on a change of target
/// after each arrival.
///
/// # Errors
/// See [`Controller::act`].
pub fn evaluate(
    controller: &dyn Controller,
    matcher: &Arc<MotionMatcher>,
    task: LocomotionTask,
    level: u32,
    count: usize,
) -> Result<LocomotionReport> {
    let mut envs = episodes(matcher, task, level, count);
    let just_reset = Episode {
        phase: Phase::Reaching,
        near: 0,
        loiters: false,
    };
    let mut running = vec![just_reset; count];
    let mut found = Found::default();
    for step in 1..=task.max_steps() + PATIENCE {
        let before = envs.state_f32.clone();
        advance(&mut envs, controller)?;
        for (env, episode) in running.iter_mut().enumerate() {
            match episode.phase {
                Phase::Reaching => found.reaching(&mut envs, env, episode, step),
                Phase::Turning { since } => {
                    found.turning(&envs, &before, env, episode, step - since)
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
            envs.retain(&left);
            running = left.iter().map(|&env| running[env]).collect();
        }
    }
    Ok(found.report(task, count))
}

impl Found {
    /// A step of a character under way to its target.
    fn reaching(&mut self, envs: &mut CpuLocomotion, env: usize, episode: &mut Episode, step: u32) {
        let task = envs.params.task;
        let near = distance(envs, &envs.state_f32, env) <= LOITER_DISTANCE;
        episode.near = if near { episode.near + 1 } else { 0 };
        let termination = envs.termination[env];
        episode.loiters |= episode.near > LOITER_STEPS && termination != termination::SUCCESS;
        if termination == termination::RUNNING {
            return;
        }
        self.steps += f64::from(step);
        self.loiterers += usize::from(episode.loiters);
        self.collisions += usize::from(termination == termination::FAILED);
        episode.phase = Phase::Done;
        if termination == termination::SUCCESS {
            let path = envs.field(state_f32::TRAVELLED, env);
            let straight = envs
                .field(state_f32::X, env)
                .hypot(envs.field(state_f32::Z, env));
            self.times.push(f64::from(step as f32 * STEP_S));
            self.ratios.push(f64::from(path / straight));
            self.walked += f64::from(path);
            if turns(task) {
                send_elsewhere(envs, env);
                episode.phase = Phase::Turning { since: step };
            }
        }
    }

    /// A step of a character whose target has moved, `waited` steps ago.
    fn turning(
        &mut self,
        envs: &CpuLocomotion,
        before: &[f32],
        env: usize,
        episode: &mut Episode,
        waited: u32,
    ) {
        let nearer = distance(envs, before, env) - distance(envs, &envs.state_f32, env);
        if nearer / STEP_S >= NEARING || waited >= PATIENCE {
            self.delays.push(f64::from(waited as f32 * STEP_S));
            episode.phase = Phase::Done;
        }
    }

    fn report(mut self, task: LocomotionTask, episodes: usize) -> LocomotionReport {
        self.times.sort_by(f64::total_cmp);
        let p95 = (self.times.len() * 95).div_ceil(100).saturating_sub(1);
        let share = |count: usize| count as f64 / episodes as f64;
        LocomotionReport {
            episodes,
            success: share(self.times.len()),
            collision: share(self.collisions),
            loiter: share(self.loiterers),
            time_to_target_mean_s: mean(&self.times),
            time_to_target_p95_s: self.times.get(p95).copied().unwrap_or(0.0),
            path_ratio: mean(&self.ratios),
            mean_speed: self.walked / self.times.iter().sum::<f64>().max(1e-9),
            episode_length_mean_s: self.steps * f64::from(STEP_S) / episodes as f64,
            turn_delay_mean_s: turns(task).then(|| mean(&self.delays)),
        }
    }
}

/// Whether an arrival is followed by a change of target.
fn turns(task: LocomotionTask) -> bool {
    task.arena_half_extent().is_none()
}

/// The distance from a character to its target, m, in a state of the environments.
fn distance(envs: &CpuLocomotion, state_f32: &[f32], env: usize) -> f32 {
    let at = |field: usize| state_f32[field * envs.params.envs + env];
    let x = at(state_f32::TARGET_X) - at(state_f32::X);
    x.hypot(at(state_f32::TARGET_Z) - at(state_f32::Z))
}

/// The mean; 0 of nothing, so that reports stay plain numbers.
fn mean(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |sum, value| sum + value) / values.len().max(1) as f64
}

/// Moves one character's target to a random position of the task's square, at least 2 m (or two fifths
/// of the square's half side) away, so that there is something to turn to. Without an arena the square
/// is around the character; in an arena it is the arena's, and the target is clear of obstacles.
pub fn send_elsewhere(envs: &mut CpuLocomotion, env: usize) {
    const STREAM: u32 = 0x5455_524e;
    let extent = envs.params.task.target_extent(LEVELS - 1);
    let at = [state_f32::X, state_f32::Z].map(|field| envs.field(field, env));
    let centre = match envs.params.task.arena_half_extent() {
        None => at,
        Some(_) => [0.0; 2],
    };
    // Keyed by where it stands, which does not change when others leave the batch.
    let bits = (0..).map(|draw| random4(EPISODES_SEED, at[0].to_bits(), draw, STREAM));
    let places = bits.map(|bits| {
        let [x, z] = [bits[0], bits[1]].map(|b| (2.0 * uniform01(b) - 1.0) * extent);
        [centre[0] + x, centre[1] + z]
    });
    let least = (extent * 0.4).min(2.0);
    let far = |place: &[f32; 2]| (place[0] - at[0]).hypot(place[1] - at[1]) >= least;
    let place = places
        .take(64)
        .find(|place| far(place) && !envs.blocked(env, *place))
        .unwrap_or(centre.map(|c| c + extent));
    envs.set_target(env, place);
}
