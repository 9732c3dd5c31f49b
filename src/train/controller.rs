//! Who steers a character.

use crate::motion::RATE;
use crate::motion::database::Database;
use crate::motion::features::{POSE_DIM, TRAJECTORY_DIM, TRAJECTORY_OFFSETS};
use crate::nn::Policy;
use anyhow::Result;

/// Anything that requests trajectories.
pub trait Controller {
    /// Normalised actions `[envs][TRAJECTORY_DIM]` for observations `[envs][width]`.
    ///
    /// # Errors
    /// The device was lost.
    fn act(&self, observation: &[f32], width: usize) -> Result<Vec<f32>>;
}

/// A policy's mean, without exploration.
impl Controller for Policy {
    fn act(&self, observation: &[f32], _width: usize) -> Result<Vec<f32>> {
        Ok(self.mean(observation))
    }
}

/// Scripted motion matching: requests a straight trajectory to the target at one speed.
pub struct Scripted<'a> {
    /// Whose normalisation the requests are in.
    pub database: &'a Database,
    /// m/s
    pub speed: f32,
}

impl Controller for Scripted<'_> {
    fn act(&self, observation: &[f32], width: usize) -> Result<Vec<f32>> {
        let normal = &self.database.normalisation;
        let mut action = Vec::with_capacity(observation.len() / width * TRAJECTORY_DIM);
        for row in observation.chunks_exact(width) {
            // Its scale does not matter for its direction.
            let target = [row[POSE_DIM], row[POSE_DIM + 1]];
            let length = target[0].hypot(target[1]).max(1e-6);
            let direction = target.map(|part| part / length);
            for (k, ahead) in TRAJECTORY_OFFSETS.iter().enumerate() {
                let far = self.speed * *ahead as f32 / RATE;
                let requested = [
                    direction[0] * far,
                    direction[1] * far,
                    direction[0],
                    direction[1],
                ];
                for (i, value) in requested.into_iter().enumerate() {
                    let at = POSE_DIM + 4 * k + i;
                    action.push((value - normal.mean[at]) * normal.scale[at]);
                }
            }
        }
        Ok(action)
    }
}
