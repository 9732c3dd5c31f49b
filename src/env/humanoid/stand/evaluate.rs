//! How well a policy stands: a number of episodes, played to their end on the CPU.

use super::{Stand, StandTask};
use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::env::humanoid::task::play::play_episodes;
use crate::env::humanoid::task::{CpuHumanoidEnv, DT};
use crate::kernels::termination;
use serde::Serialize;
use std::sync::Arc;

/// How a policy fared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StandReport {
    /// Episodes played.
    pub episodes: usize,
    /// Fraction of the episodes that did not end by a fall.
    pub survival: f64,
    /// Mean length of an episode, s.
    pub mean_episode_s: f64,
    /// Mean over all steps of the cosine between the torso's up axis and the world's.
    pub mean_uprightness: f64,
}

/// Plays `episodes` episodes, whose starts and pushes depend on `seed` alone.
pub fn evaluate(stand: &Stand, driver: &dyn BodyDriver, episodes: usize, seed: u32) -> StandReport {
    let task = Arc::new(StandTask::new(stand, seed));
    let mut envs = CpuHumanoidEnv::unstaggered(task, 0..episodes, seed);
    let found = play_episodes(&mut envs, driver, DriverState::default(), |_, _, _| ());
    // Of all statistics these are the third and the last.
    let (steps, upright) = (found.mean(2), found.mean(5));
    StandReport {
        episodes,
        survival: found.fraction(1 << termination::TRUNCATED),
        mean_episode_s: steps * f64::from(DT),
        mean_uprightness: upright / f64::max(steps, 1.0),
    }
}
