//! What a world of the task `box` carries; `shaders/shared/boxing.wgsl` has the same numbers. Two numbers are
//! those of the two fighters.

use crate::gpu::shader::boxing_reward::constants as at;

/// Index of the impulses of each fighter's hands on the other's head and torso in this bout, N s, two numbers.
pub const DAMAGE: usize = at::DAMAGE as usize;
/// Index of the knock-downs by each fighter in this bout, two numbers.
pub const KNOCKDOWNS: usize = at::KNOCKDOWNS as usize;
/// Index of 1 for each fighter that lay after the last step, two numbers.
pub const DOWN: usize = at::DOWN as usize;
/// Index of the squared accelerations of all joints in the last step, rad^2/s^4, two numbers.
pub const SQUARED_ACCELERATION: usize = at::SQUARED_ACCELERATION as usize;
/// Index of the steps for which both have been in a clinch.
pub const CLINCH_STEPS: usize = at::CLINCH_STEPS as usize;
/// Index of the steps that are left in which a fall of each fighter's opponent is its doing, two numbers.
pub const STAGGER_STEPS: usize = at::STAGGER_STEPS as usize;
/// Index of the speeds of one fighter's joints and then the other's after the last step, rad/s.
pub const JOINT_SPEEDS: usize = at::JOINT_SPEEDS as usize;
/// Degrees of freedom of a fighter's root, which come before those of its joints.
pub const ROOT_DOFS: usize = at::ROOT_DOFS as usize;

/// Numbers of a world whose fighters have so many degrees of freedom each.
pub fn state_dim(dofs: usize) -> usize {
    JOINT_SPEEDS + 2 * (dofs - ROOT_DOFS)
}
