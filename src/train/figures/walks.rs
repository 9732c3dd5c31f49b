//! The walks of a policy by motion matching, seen from above, whatever the task.

use super::{obstacles, plane};
use crate::env::locomotion::LocomotionTask;
use crate::nn::Policy;
use crate::train::locomotion::Locomotion;
use anyhow::Result;
use std::path::Path;

/// Draws the walks of a policy after so many steps into a PNG file.
///
/// # Errors
/// It cannot be written.
pub fn draw_walks(of: &Locomotion, policy: &Policy, steps: u64, path: &Path) -> Result<()> {
    match of.task {
        LocomotionTask::Plane(_) => plane::draw_walks(of, policy, steps, path),
        LocomotionTask::Obstacles(_) => obstacles::draw_walks(of, policy, path),
    }
}
