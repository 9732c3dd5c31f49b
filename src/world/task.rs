//! What is asked of the character.

use serde::{Deserialize, Serialize};

/// Reach a target on an empty plane (paper, section 3; equation 3).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plane {
    /// Targets are drawn uniformly from a square of twice this side around the start, m.
    pub half_side: f32,
    /// The target is reached within this distance, and never drawn within it, m.
    pub reach: f32,
    /// Reward for reaching it.
    pub bonus: f32,
    /// Steps after which an episode is truncated.
    pub max_steps: u32,
}

impl Default for Plane {
    fn default() -> Self {
        Plane {
            half_side: 5.0,
            reach: 0.5,
            bonus: 1000.0,
            max_steps: 200,
        }
    }
}
