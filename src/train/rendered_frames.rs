//! What a policy's characters showed, frame by frame.

use super::controller::Controller;
use super::evaluate::{advance, episodes};
use crate::kernels::locomotion::locomotion_layout::{state_f32, state_u32};
use crate::kernels::termination;
use crate::motion::database::Database;
use crate::motion::features::FRAMES_PER_STEP;
use crate::playback::PlacedFrame;
use crate::env::locomotion::cpu::CpuLocomotion;
use crate::env::locomotion::{LEVELS, Task};
use anyhow::Result;
use std::sync::Arc;

/// The first `count` evaluation episodes on the hardest level, each to its end: the frame it began
/// with, then every frame it showed.
pub fn shown(
    controller: &dyn Controller,
    database: &Arc<Database>,
    task: Task,
    count: usize,
) -> Result<Vec<Vec<PlacedFrame>>> {
    let mut world = episodes(database, task, LEVELS - 1, count);
    let mut walks: Vec<Vec<PlacedFrame>> = (0..count).map(|env| vec![standing(&world, env)]).collect();
    let mut running: Vec<usize> = (0..count).collect();
    while !running.is_empty() {
        let before: Vec<PlacedFrame> = (0..count).map(|env| standing(&world, env)).collect();
        advance(&mut world, controller)?;
        for &env in &running {
            let matched = database.candidates[world.matched[env] as usize] as usize;
            // A match changes the frame alone: the character stays where it is.
            let from = PlacedFrame {
                frame: matched,
                ..before[env]
            };
            walks[env].extend((1..=FRAMES_PER_STEP as isize).map(|ahead| from.on(database, ahead)));
        }
        running.retain(|&env| world.termination[env] == termination::RUNNING);
    }
    Ok(walks)
}

/// The frame that a character shows, and where.
pub fn standing(world: &CpuLocomotion, env: usize) -> PlacedFrame {
    PlacedFrame {
        frame: world.state_u32[state_u32::FRAME * world.rules.envs + env] as usize,
        at: [state_f32::X, state_f32::Z].map(|field| world.field(field, env)),
        heading: [state_f32::HEADING_X, state_f32::HEADING_Z].map(|field| world.field(field, env)),
    }
}
