//! Who steers a character.

use super::checkpoint::Checkpoint;
use crate::motion::RATE;
use crate::motion::database::Database;
use crate::motion::features::{TRAJECTORY_OFFSETS, POSE_DIM, TRAJECTORY_DIM};
use crate::nn::network::Shape;
use crate::nn::policy::Policy;
use crate::nn::tensors;
use anyhow::Result;
use burn::tensor::Device;

/// Anything that asks for trajectories.
pub trait Controller {
    /// Normalised actions `[envs][TRAJECTORY_DIM]` for observations `[envs][width]`.
    fn act(&self, observation: &[f32], width: usize) -> Result<Vec<f32>>;
}

/// A trained policy's mean, without exploration.
pub struct Trained {
    policy: Policy,
    device: Device,
}

impl Trained {
    pub fn new(shape: &Shape, parameters: &[f32]) -> Self {
        let device = Device::flex();
        Trained {
            policy: shape.cut(&tensors::vector(parameters, &device)),
            device,
        }
    }
}

impl From<&Checkpoint> for Trained {
    fn from(checkpoint: &Checkpoint) -> Self {
        Trained::new(&checkpoint.shape, &checkpoint.parameters)
    }
}

impl Controller for Trained {
    fn act(&self, observation: &[f32], width: usize) -> Result<Vec<f32>> {
        let shape = [observation.len() / width, width];
        let observation = tensors::upload(observation.to_vec(), shape, &self.device);
        tensors::read(self.policy.mean(observation))
    }
}

/// Scripted motion matching: asks for a straight walk to the target at one speed.
pub struct Scripted<'a> {
    pub database: &'a Database,
    /// m/s
    pub speed: f32,
}

impl Controller for Scripted<'_> {
    fn act(&self, observation: &[f32], width: usize) -> Result<Vec<f32>> {
        let normal = &self.database.normalisation;
        let mut action = Vec::with_capacity(observation.len() / width * TRAJECTORY_DIM);
        for row in observation.chunks_exact(width) {
            // The goal's scale does not matter for its direction.
            let goal = [row[POSE_DIM], row[POSE_DIM + 1]];
            let length = goal[0].hypot(goal[1]).max(1e-6);
            let direction = goal.map(|g| g / length);
            for (k, ahead) in TRAJECTORY_OFFSETS.iter().enumerate() {
                let far = self.speed * *ahead as f32 / RATE;
                let asked = [
                    direction[0] * far,
                    direction[1] * far,
                    direction[0],
                    direction[1],
                ];
                for (i, value) in asked.into_iter().enumerate() {
                    let at = POSE_DIM + 4 * k + i;
                    action.push((value - normal.mean[at]) * normal.scale[at]);
                }
            }
        }
        Ok(action)
    }
}
