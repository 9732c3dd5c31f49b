//! Length and failures of an episode.

use crate::physics::simulator::{STEP_RATE, SUBSTEPS};
use serde::{Deserialize, Serialize};

/// Steps a second.
pub const RATE: f32 = STEP_RATE / SUBSTEPS as f32;
/// Length of a step, s.
pub const DT: f32 = 1.0 / RATE;

/// How long an episode lasts, and when it has failed before.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EpisodeRules {
    /// Length of an episode, s.
    pub episode_s: f32,
    /// Height of the head below which the character has fallen, m.
    pub min_head_height: f32,
    /// Height of the pelvis below which it has fallen, m.
    pub min_pelvis_height: f32,
    /// Height of any body but the feet below which it has fallen, m.
    pub min_body_height: f32,
}

impl Default for EpisodeRules {
    fn default() -> Self {
        EpisodeRules {
            episode_s: 10.0,
            min_head_height: 0.9,
            min_pelvis_height: 0.5,
            min_body_height: 0.15,
        }
    }
}

impl EpisodeRules {
    /// Steps of an episode.
    pub fn steps(&self) -> u32 {
        (self.episode_s / DT).round() as u32
    }

    /// Whether the rules can be played by.
    ///
    /// # Errors
    /// The first that cannot.
    pub fn check(&self) -> Result<(), String> {
        if !(DT..=3600.0).contains(&self.episode_s) {
            return Err("episode_s must lie between 0.04 and 3600 s".into());
        }
        check_range(&[
            ("min_head_height", self.min_head_height),
            ("min_pelvis_height", self.min_pelvis_height),
            ("min_body_height", self.min_body_height),
        ])
    }
}

/// Refuses numbers that are negative, huge or none.
///
/// # Errors
/// The first of them, by name.
pub fn check_range(choices: &[(&str, f32)]) -> Result<(), String> {
    let wrong = choices
        .iter()
        .find(|(_, value)| !(0.0..=1000.0).contains(value));
    match wrong {
        Some((name, _)) => Err(format!("{name} must lie between 0 and 1000")),
        None => Ok(()),
    }
}
