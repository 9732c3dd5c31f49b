//! Walks of a policy, for pictures.

use super::controller::Controller;
use super::evaluate::{SECONDS_A_STEP, advance, episodes};
use crate::kernels::locomotion::locomotion_layout::{MAPS, boxes, state_f32};
use crate::kernels::termination;
use crate::kernels::locomotion::rasterize_maps::cell;
use crate::motion::database::Database;
use crate::motion::character_frame::to_local;
use crate::report::obstacle_walks::{End, Episode, Map, Obstacle};
use crate::env::locomotion::cpu::CpuLocomotion;
use crate::env::locomotion::{LEVELS, Task};
use anyhow::Result;
use std::sync::Arc;

/// One episode's walk.
#[derive(Clone, Debug, PartialEq)]
pub struct Walk {
    /// Root on the ground after every step, `[x, z]`, m.
    pub points: Vec<[f32; 2]>,
    pub target: [f32; 2],
    pub reached: bool,
}

impl Walk {
    pub fn seconds(&self) -> f32 {
        (self.points.len() - 1) as f32 * SECONDS_A_STEP
    }
}

/// The walks of the first `count` evaluation episodes, turned so that each starts facing +z.
pub fn walks(
    controller: &dyn Controller,
    database: &Arc<Database>,
    task: Task,
    count: usize,
) -> Result<Vec<Walk>> {
    let mut world = episodes(database, task, LEVELS - 1, count);
    let headings: Vec<[f32; 2]> = (0..count)
        .map(|env| [state_f32::HEADING_X, state_f32::HEADING_Z].map(|field| world.field(field, env)))
        .collect();
    let at = |world: &CpuLocomotion, env: usize, x: usize, z: usize| {
        to_local([world.field(x, env), world.field(z, env)], headings[env])
    };
    let mut walks: Vec<Walk> = (0..count)
        .map(|env| Walk {
            points: vec![[0.0; 2]],
            target: at(&world, env, state_f32::TARGET_X, state_f32::TARGET_Z),
            reached: false,
        })
        .collect();
    for _ in 0..task.max_steps() {
        advance(&mut world, controller)?;
        let under_way = walks
            .iter_mut()
            .enumerate()
            .filter(|(_, walk)| !walk.reached);
        for (env, walk) in under_way {
            walk.points.push(at(&world, env, state_f32::X, state_f32::Z));
            walk.reached = world.termination[env] == termination::SUCCESS;
        }
        if walks.iter().all(|walk| walk.reached) {
            break;
        }
    }
    Ok(walks)
}

/// The first `count` evaluation episodes on the hardest level, in the world's axes, with the maps as
/// they were seen half-way.
pub fn among_obstacles(
    controller: &dyn Controller,
    database: &Arc<Database>,
    task: Task,
    count: usize,
) -> Result<Vec<Episode>> {
    (0..count)
        .map(|env| {
            let mut world = episodes(database, task, LEVELS - 1, count);
            world.keep(&[env]);
            let title = format!("level {}, episode {}", LEVELS - 1, env + 1);
            obstacle_walk(controller, world, title)
        })
        .collect()
}

/// The walk of a world of one.
fn obstacle_walk(
    controller: &dyn Controller,
    mut world: CpuLocomotion,
    title: String,
) -> Result<Episode> {
    let place = |world: &CpuLocomotion, x: usize, z: usize| [world.field(x, 0), world.field(z, 0)];
    let starts = world.boxes.clone();
    let mut points = vec![place(&world, state_f32::X, state_f32::Z)];
    let mut seen = vec![(heading(&world), maps(&world))];
    while world.termination[0] == termination::RUNNING {
        advance(&mut world, controller)?;
        points.push(place(&world, state_f32::X, state_f32::Z));
        seen.push((heading(&world), maps(&world)));
    }
    let moment = points.len() / 2;
    let (heading, maps) = seen[moment];
    let count = world.rules.task.obstacles();
    let field = |of: &[f32], field: usize, slot: usize| of[field * count + slot];
    let obstacles = (0..count).map(|slot| Obstacle {
        start: [boxes::X, boxes::Z].map(|at| field(&starts, at, slot)),
        end: [boxes::X, boxes::Z].map(|at| field(&world.boxes, at, slot)),
        half: [boxes::HALF_X, boxes::HALF_Z].map(|at| field(&world.boxes, at, slot)),
    });
    Ok(Episode {
        title,
        obstacles: obstacles.collect(),
        points,
        target: place(&world, state_f32::TARGET_X, state_f32::TARGET_Z),
        end: match world.termination[0] {
            termination::SUCCESS => End::Reached,
            termination::FAILED => End::Collided,
            _ => End::UnderWay,
        },
        seen: moment,
        heading,
        maps,
    })
}

fn heading(world: &CpuLocomotion) -> [f32; 2] {
    [state_f32::HEADING_X, state_f32::HEADING_Z].map(|field| world.field(field, 0))
}

/// The maps of the first world.
fn maps(world: &CpuLocomotion) -> [Map; MAPS] {
    std::array::from_fn(|map| {
        std::array::from_fn(|row| std::array::from_fn(|column| cell(&world.maps, map, row, column)))
    })
}
