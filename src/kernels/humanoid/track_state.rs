//! What a world of the task `track` carries; `shaders/shared/track.wgsl` has the same numbers.

use crate::gpu::shader::track_reward::constants as at;

/// Index of the row of the references at which the body should be now.
pub const ROW: usize = at::ROW as usize;
/// Index of the last row of the motion.
pub const LAST: usize = at::LAST as usize;
/// Numbers of a world.
pub const TRACK_STATE: usize = at::TRACK_STATE as usize;
