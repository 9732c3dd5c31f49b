//! Places and widths that shaders and Rust share; checked at compile time against
//! `shaders/shared/locomotion_layout.wgsl`.

use crate::gpu::shader::advance_and_reward::constants as wgsl;
use crate::motion::features::{FEATURE_DIM, FRAMES_PER_STEP, POSE_DIM, ROW_STRIDE, TRAJECTORY_DIM};

/// What every task observes: the pose feature and the target in the character frame.
pub const BASE_OBS_DIM: usize = POSE_DIM + 2;
/// An obstacle map is so many cells wide and long.
pub const CELLS: usize = 16;
/// Side of a cell, m.
pub const CELL: f32 = 0.375;
/// Maps a character sees: now, and before.
pub const MAPS: usize = 2;
/// Words of a row of a map: four cells each, a byte a cell, the first in the lowest.
pub const ROW: usize = CELLS / 4;
/// Words of an environment's maps.
pub const MAP_WORDS: usize = MAPS * CELLS * ROW;
/// A cell that lies in an obstacle.
pub const FULL: u8 = u8::MAX;
/// Numbers of an observation's maps, `[row][column][map]`: rows from behind to ahead, columns from
/// right to left in the character frame.
pub const MAP_OBS_DIM: usize = CELLS * CELLS * MAPS;
/// The target in an observation is metres times this.
pub const TARGET_SCALE: f32 = 0.2;

/// Fields of the floating-point state, `state_f32[field * envs + env]`.
pub mod state_f32 {
    /// x of the root on the ground, m.
    pub const X: usize = 0;
    /// z of the root on the ground, m.
    pub const Z: usize = 1;
    /// x of the unit forward direction in the world.
    pub const HEADING_X: usize = 2;
    /// z of the unit forward direction in the world.
    pub const HEADING_Z: usize = 3;
    /// x of the target on the ground, m.
    pub const TARGET_X: usize = 4;
    /// z of the target on the ground, m.
    pub const TARGET_Z: usize = 5;
    /// Rewards of the running episode.
    pub const RETURN: usize = 6;
    /// Metres walked in the running episode.
    pub const TRAVELLED: usize = 7;
    /// Summed returns of the episodes ended since the last tally.
    pub const RETURNS: usize = 8;
    /// Number of fields.
    pub const FIELDS: usize = 9;
}

/// Fields of the integer state, `state_u32[field * envs + env]`.
pub mod state_u32 {
    /// Database frame now shown.
    pub const FRAME: usize = 0;
    /// Steps of the running episode.
    pub const EPISODE_STEP: usize = 1;
    /// Steps after which the running episode is truncated.
    pub const EPISODE_LIMIT: usize = 2;
    /// Asked-for positions of the last step that lay in an obstacle.
    pub const HITS: usize = 3;
    /// 1 if the last step ran into an obstacle.
    pub const HAS_COLLIDED: usize = 4;
    /// Episodes ended since the last tally.
    pub const EPISODES: usize = 5;
    /// Episodes ended since the last tally by reaching the target.
    pub const SUCCESSES: usize = 6;
    /// Episodes ended since the last tally by running into an obstacle.
    pub const COLLISIONS: usize = 7;
    /// Episodes ended since the last tally by running out of steps.
    pub const TRUNCATIONS: usize = 8;
    /// Steps of the episodes ended since the last tally.
    pub const LENGTHS: usize = 9;
    /// Number of fields.
    pub const FIELDS: usize = 10;
}

/// Fields of the obstacles, `boxes[(env * FIELDS + field) * count + slot]`: axis-aligned boxes.
pub mod boxes {
    /// x of the centre, m.
    pub const X: usize = 0;
    /// z of the centre, m.
    pub const Z: usize = 1;
    /// Half the side along x, m.
    pub const HALF_X: usize = 2;
    /// Half the side along z, m.
    pub const HALF_Z: usize = 3;
    /// Number of fields.
    pub const FIELDS: usize = 4;
}

/// Axes of the obstacles' velocities, m/s, `drift[(env * VELOCITY_DIM + axis) * count + slot]`.
pub const VELOCITY_DIM: usize = 2;

const _: () = {
    assert!(wgsl::POSE_DIM as usize == POSE_DIM && wgsl::TRAJECTORY_DIM as usize == TRAJECTORY_DIM);
    assert!(wgsl::FEATURE_DIM as usize == FEATURE_DIM && wgsl::QUADS as usize * 4 == ROW_STRIDE);
    assert!(
        wgsl::BASE_OBS_DIM as usize == BASE_OBS_DIM
            && wgsl::FRAMES_PER_STEP as usize == FRAMES_PER_STEP
    );
    assert!(wgsl::CELLS as usize == CELLS && wgsl::MAPS as usize == MAPS);
    assert!(wgsl::ROW as usize == ROW);
    assert!(wgsl::X as usize == state_f32::X && wgsl::Z as usize == state_f32::Z);
    assert!(
        wgsl::HEADING_X as usize == state_f32::HEADING_X
            && wgsl::HEADING_Z as usize == state_f32::HEADING_Z
    );
    assert!(
        wgsl::TARGET_X as usize == state_f32::TARGET_X
            && wgsl::TARGET_Z as usize == state_f32::TARGET_Z
    );
    assert!(
        wgsl::RETURN as usize == state_f32::RETURN
            && wgsl::TRAVELLED as usize == state_f32::TRAVELLED
    );
    assert!(
        wgsl::RETURNS as usize == state_f32::RETURNS
            && wgsl::STATE_F32_FIELDS as usize == state_f32::FIELDS
    );
    assert!(
        wgsl::FRAME as usize == state_u32::FRAME
            && wgsl::EPISODE_STEP as usize == state_u32::EPISODE_STEP
    );
    assert!(
        wgsl::EPISODES as usize == state_u32::EPISODES
            && wgsl::SUCCESSES as usize == state_u32::SUCCESSES
    );
    assert!(
        wgsl::LENGTHS as usize == state_u32::LENGTHS
            && wgsl::STATE_U32_FIELDS as usize == state_u32::FIELDS
    );
    assert!(
        wgsl::EPISODE_LIMIT as usize == state_u32::EPISODE_LIMIT
            && wgsl::HITS as usize == state_u32::HITS
    );
    assert!(wgsl::HAS_COLLIDED as usize == state_u32::HAS_COLLIDED);
    assert!(wgsl::COLLISIONS as usize == state_u32::COLLISIONS);
    assert!(wgsl::TRUNCATIONS as usize == state_u32::TRUNCATIONS);
    assert!(wgsl::BOX_X as usize == boxes::X && wgsl::BOX_Z as usize == boxes::Z);
    assert!(wgsl::HALF_X as usize == boxes::HALF_X && wgsl::HALF_Z as usize == boxes::HALF_Z);
    assert!(wgsl::BOX as usize == boxes::FIELDS && wgsl::VELOCITY_DIM as usize == VELOCITY_DIM);
};
