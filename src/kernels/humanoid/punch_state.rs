//! What a world of the tasks `punch` and `joystick` carries; `shaders/shared/punch.wgsl` has the same numbers.

use crate::gpu::shader::punch_reward::constants as at;

/// Index of the wanted facing, a unit vector on the ground, two numbers.
pub const FACING: usize = at::FACING as usize;
/// Index of the wanted direction of moving, two numbers.
pub const MOVING: usize = at::MOVING as usize;
/// Index of the steps since the target was hit; 0 before.
pub const HIT_STEPS: usize = at::HIT_STEPS as usize;
/// Index of 1 + the body that touched the target first; 0 before.
pub const FIRST: usize = at::FIRST as usize;
/// Index of the speed of the faster hand then, m/s.
pub const FIRST_SPEED: usize = at::FIRST_SPEED as usize;
/// Index of the speed of the faster hand after the last step, m/s.
pub const HAND_SPEED: usize = at::HAND_SPEED as usize;
/// Numbers of a world.
pub const PUNCH_STATE: usize = at::PUNCH_STATE as usize;
