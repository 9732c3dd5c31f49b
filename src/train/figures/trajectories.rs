//! Episodes of a policy, for pictures.

use crate::env::locomotion::cpu::CpuLocomotion;
use crate::env::locomotion::{LEVELS, LocomotionTask, STEP_S};
use crate::kernels::locomotion::locomotion_layout::{MAPS, boxes, state_f32};
use crate::kernels::locomotion::rasterize_maps::cell;
use crate::kernels::termination;
use crate::matching::MotionMatcher;
use crate::motion::character_frame::to_local;
use crate::report::obstacle_walks::{DrawnEpisode, End, Map, Obstacle};
use crate::train::controller::Controller;
use crate::train::evaluate::{advance, episodes};
use anyhow::Result;
use std::sync::Arc;

/// The way of an episode.
#[derive(Clone, Debug, PartialEq)]
pub struct EpisodeTrajectory {
    /// Root on the ground after every step, `[x, z]`, m.
    pub points: Vec<[f32; 2]>,
    /// Target on the ground, `[x, z]`, m.
    pub target: [f32; 2],
    /// Whether the target was reached.
    pub reached: bool,
}

impl EpisodeTrajectory {
    /// Length of the episode, s.
    pub fn seconds(&self) -> f32 {
        (self.points.len() - 1) as f32 * STEP_S
    }
}

/// The first `count` evaluation episodes on the hardest level, rotated so that each starts facing +z.
///
/// # Errors
/// See [`Controller::act`].
pub fn trajectories(
    controller: &dyn Controller,
    matcher: &Arc<MotionMatcher>,
    task: LocomotionTask,
    count: usize,
) -> Result<Vec<EpisodeTrajectory>> {
    let mut envs = episodes(matcher, task, LEVELS - 1, count);
    let headings: Vec<[f32; 2]> = (0..count)
        .map(|env| [state_f32::HEADING_X, state_f32::HEADING_Z].map(|field| envs.field(field, env)))
        .collect();
    let at = |envs: &CpuLocomotion, env: usize, x: usize, z: usize| {
        to_local([envs.field(x, env), envs.field(z, env)], headings[env])
    };
    let mut all: Vec<EpisodeTrajectory> = (0..count)
        .map(|env| EpisodeTrajectory {
            points: vec![[0.0; 2]],
            target: at(&envs, env, state_f32::TARGET_X, state_f32::TARGET_Z),
            reached: false,
        })
        .collect();
    for _ in 0..task.max_steps() {
        advance(&mut envs, controller)?;
        let under_way = all.iter_mut().enumerate().filter(|(_, one)| !one.reached);
        for (env, one) in under_way {
            one.points.push(at(&envs, env, state_f32::X, state_f32::Z));
            one.reached = envs.termination[env] == termination::SUCCESS;
        }
        if all.iter().all(|one| one.reached) {
            break;
        }
    }
    Ok(all)
}

/// The first `count` evaluation episodes on the hardest level, in the world's axes, with the maps as
/// they were seen half-way.
///
/// # Errors
/// See [`Controller::act`].
pub fn among_obstacles(
    controller: &dyn Controller,
    matcher: &Arc<MotionMatcher>,
    task: LocomotionTask,
    count: usize,
) -> Result<Vec<DrawnEpisode>> {
    (0..count)
        .map(|env| {
            let mut envs = episodes(matcher, task, LEVELS - 1, count);
            envs.retain(&[env]);
            let title = format!("level {}, episode {}", LEVELS - 1, env + 1);
            obstacle_episode(controller, envs, title)
        })
        .collect()
}

/// The episode of a single environment.
fn obstacle_episode(
    controller: &dyn Controller,
    mut envs: CpuLocomotion,
    title: String,
) -> Result<DrawnEpisode> {
    let place = |envs: &CpuLocomotion, x: usize, z: usize| [envs.field(x, 0), envs.field(z, 0)];
    let starts = envs.boxes.clone();
    let mut points = vec![place(&envs, state_f32::X, state_f32::Z)];
    let mut seen = vec![(heading(&envs), maps(&envs))];
    while envs.termination[0] == termination::RUNNING {
        advance(&mut envs, controller)?;
        points.push(place(&envs, state_f32::X, state_f32::Z));
        seen.push((heading(&envs), maps(&envs)));
    }
    let moment = points.len() / 2;
    let (heading, maps) = seen[moment];
    let count = envs.params.task.obstacles();
    let field = |of: &[f32], field: usize, slot: usize| of[field * count + slot];
    let obstacles = (0..count).map(|slot| Obstacle {
        start: [boxes::X, boxes::Z].map(|at| field(&starts, at, slot)),
        end: [boxes::X, boxes::Z].map(|at| field(&envs.boxes, at, slot)),
        half: [boxes::HALF_X, boxes::HALF_Z].map(|at| field(&envs.boxes, at, slot)),
    });
    Ok(DrawnEpisode {
        title,
        obstacles: obstacles.collect(),
        points,
        target: place(&envs, state_f32::TARGET_X, state_f32::TARGET_Z),
        end: match envs.termination[0] {
            termination::SUCCESS => End::Reached,
            termination::FAILED => End::Collided,
            _ => End::UnderWay,
        },
        seen: moment,
        heading,
        maps,
    })
}

fn heading(envs: &CpuLocomotion) -> [f32; 2] {
    [state_f32::HEADING_X, state_f32::HEADING_Z].map(|field| envs.field(field, 0))
}

/// The maps of the first environment.
fn maps(envs: &CpuLocomotion) -> [Map; MAPS] {
    std::array::from_fn(|map| {
        std::array::from_fn(|row| std::array::from_fn(|column| cell(&envs.maps, map, row, column)))
    })
}
