//! The frames that a policy's characters show.

use super::controller::Controller;
use super::evaluate::{advance, episodes};
use crate::env::locomotion::cpu::CpuLocomotion;
use crate::env::locomotion::{LEVELS, LocomotionTask};
use crate::kernels::locomotion::locomotion_layout::{state_f32, state_u32};
use crate::kernels::termination;
use crate::matching::MotionMatcher;
use crate::motion::features::FRAMES_PER_STEP;
use crate::playback::PlacedFrame;
use anyhow::Result;
use std::sync::Arc;

/// The first `count` evaluation episodes on the hardest level, each to its end: the frame it began
/// with, then every frame it showed.
///
/// # Errors
/// See [`Controller::act`].
pub fn rendered_frames(
    controller: &dyn Controller,
    matcher: &Arc<MotionMatcher>,
    task: LocomotionTask,
    count: usize,
) -> Result<Vec<Vec<PlacedFrame>>> {
    let database = &matcher.database;
    let mut envs = episodes(matcher, task, LEVELS - 1, count);
    let mut shown: Vec<Vec<PlacedFrame>> =
        (0..count).map(|env| vec![standing(&envs, env)]).collect();
    let mut running: Vec<usize> = (0..count).collect();
    while !running.is_empty() {
        let before: Vec<PlacedFrame> = (0..count).map(|env| standing(&envs, env)).collect();
        advance(&mut envs, controller)?;
        for &env in &running {
            let matched = database.candidates[envs.matched[env] as usize] as usize;
            // A match changes the frame alone: the character stays where it is.
            let from = PlacedFrame {
                frame: matched,
                ..before[env]
            };
            shown[env].extend((1..=FRAMES_PER_STEP as isize).map(|ahead| from.on(database, ahead)));
        }
        running.retain(|&env| envs.termination[env] == termination::RUNNING);
    }
    Ok(shown)
}

/// The frame that a character shows, and where.
pub fn standing(envs: &CpuLocomotion, env: usize) -> PlacedFrame {
    PlacedFrame {
        frame: envs.state_u32[state_u32::FRAME * envs.params.envs + env] as usize,
        at: [state_f32::X, state_f32::Z].map(|field| envs.field(field, env)),
        heading: [state_f32::HEADING_X, state_f32::HEADING_Z].map(|field| envs.field(field, env)),
    }
}
