//! What full knowledge could reach: a beam search that sees every obstacle and plays every match
//! forward before it chooses. What it cannot reach may still be reachable; what it does
//! reach bounds from below what a policy might.

use super::evaluate::episodes;
use crate::env::locomotion::LocomotionTask;
use crate::env::locomotion::cpu::CpuLocomotion;
use crate::kernels::locomotion::locomotion_layout::state_f32;
use crate::kernels::termination;
use crate::matching::MotionMatcher;
use crate::motion::RATE;
use crate::motion::character_frame::to_local;
use crate::motion::database::Database;
use crate::motion::features::{POSE_DIM, TRAJECTORY_DIM, TRAJECTORY_OFFSETS};
use serde::Serialize;
use std::collections::HashSet;
use std::sync::Arc;

/// Episodes planned together.
const CHUNK: usize = 16;
/// Steps looked ahead: 12 s.
const DEPTH: usize = 60;
/// Places an episode goes on from at every step; two thirds are the nearest to the target.
const BEAM: usize = 24;
/// Two places this near are one, m.
const SAME: f32 = 0.2;
/// Speeds asked for, m/s, and directions around the character; standing still and walking straight
/// to the target besides.
const SPEEDS: [f32; 2] = [1.2, 3.0];
const DIRECTIONS: usize = 10;
const ACTIONS: usize = SPEEDS.len() * (DIRECTIONS + 1) + 1;

/// What the planner found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Planned {
    /// Episodes planned.
    pub episodes: usize,
    /// Fraction that a plan takes to the target.
    pub success: f64,
}

/// Plans the first `count` evaluation episodes of a level.
pub fn plan(
    matcher: &Arc<MotionMatcher>,
    task: LocomotionTask,
    level: u32,
    count: usize,
) -> Planned {
    let all = episodes(matcher, task, level, count);
    let ids: Vec<usize> = (0..count).collect();
    let reached: usize = ids
        .chunks(CHUNK)
        .map(|chunk| {
            let mut envs = all.clone();
            envs.retain(chunk);
            explore(envs, &matcher.database)
        })
        .sum();
    Planned {
        episodes: count,
        success: reached as f64 / count as f64,
    }
}

/// How many of a envs's episodes can be taken to their target.
fn explore(mut envs: CpuLocomotion, database: &Database) -> usize {
    let count = envs.params.envs;
    // Which episode each envs tries.
    let mut episode: Vec<usize> = (0..count).collect();
    let mut reached = vec![false; count];
    for _ in 0..DEPTH {
        let children: Vec<usize> = (0..episode.len() * ACTIONS).map(|i| i / ACTIONS).collect();
        envs.retain(&children);
        episode = children.iter().map(|&parent| episode[parent]).collect();
        let actions = actions(&envs, database);
        envs.step_without_reset(&actions);
        for (env, &episode) in episode.iter().enumerate() {
            reached[episode] |= envs.termination[env] == termination::SUCCESS;
        }
        let chosen: Vec<usize> = (0..count)
            .filter(|&one| !reached[one])
            .flat_map(|one| choose(&envs, &episode, one))
            .collect();
        if chosen.is_empty() {
            break;
        }
        envs.retain(&chosen);
        episode = chosen.iter().map(|&env| episode[env]).collect();
    }
    reached.into_iter().filter(|&reached| reached).count()
}

/// The envss one episode goes on from: the nearest to the target, and some of the others for ways
/// around.
fn choose(envs: &CpuLocomotion, episode: &[usize], one: usize) -> Vec<usize> {
    let at = |env: usize| [state_f32::X, state_f32::Z].map(|field| envs.field(field, env));
    let left = |env: usize| {
        let [x, z] = at(env);
        (envs.field(state_f32::TARGET_X, env) - x).hypot(envs.field(state_f32::TARGET_Z, env) - z)
    };
    let mut alive: Vec<usize> = (0..episode.len())
        .filter(|&env| episode[env] == one && envs.termination[env] == termination::RUNNING)
        .collect();
    alive.sort_by(|&a, &b| left(a).total_cmp(&left(b)));
    let mut taken = HashSet::new();
    alive.retain(|&env| taken.insert(at(env).map(|place| (place / SAME).round() as i32)));
    let near = BEAM * 2 / 3;
    let rest = alive.len().saturating_sub(near);
    let every = rest.div_ceil(BEAM - near).max(1);
    let others = alive.iter().skip(near).step_by(every);
    alive.iter().take(near).chain(others).copied().collect()
}

/// Normalised actions: each envs its own of the [`ACTIONS`] kinds, in turn.
fn actions(envs: &CpuLocomotion, database: &Database) -> Vec<f32> {
    let normal = &database.normalisation;
    let mut actions = Vec::with_capacity(envs.params.envs * TRAJECTORY_DIM);
    for env in 0..envs.params.envs {
        let (direction, speed) = asked(envs, env);
        for (k, ahead) in TRAJECTORY_OFFSETS.iter().enumerate() {
            let far = speed * *ahead as f32 / RATE;
            let [x, z] = direction;
            for (i, value) in [x * far, z * far, x, z].into_iter().enumerate() {
                let at = POSE_DIM + 4 * k + i;
                actions.push((value - normal.mean[at]) * normal.scale[at]);
            }
        }
    }
    actions
}

/// Direction in the character frame and speed of a envs's kind of action.
fn asked(envs: &CpuLocomotion, env: usize) -> ([f32; 2], f32) {
    let kind = env % ACTIONS;
    if kind == ACTIONS - 1 {
        return ([0.0, 1.0], 0.0);
    }
    let (speed, way) = (SPEEDS[kind % SPEEDS.len()], kind / SPEEDS.len());
    if way < DIRECTIONS {
        let angle = std::f32::consts::TAU * way as f32 / DIRECTIONS as f32;
        return ([angle.sin(), angle.cos()], speed);
    }
    let field = |field: usize| envs.field(field, env);
    let offset = [
        field(state_f32::TARGET_X) - field(state_f32::X),
        field(state_f32::TARGET_Z) - field(state_f32::Z),
    ];
    let goal = to_local(
        offset,
        [field(state_f32::HEADING_X), field(state_f32::HEADING_Z)],
    );
    let length = goal[0].hypot(goal[1]).max(1e-6);
    (goal.map(|g| g / length), speed)
}
