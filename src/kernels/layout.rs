//! Places and widths that shaders and Rust share; checked against `shaders/shared/layout.wgsl`
//! at compile time.

use crate::gpu::shader::step::constants as wgsl;
use crate::motion::database::PADDED;
use crate::motion::features::{FEATURE, PLAYED, POSE, TRAJECTORY};

/// Width of an observation: the pose feature and the target in the character frame.
pub const OBSERVATION: usize = POSE + 2;
/// The target in an observation is metres times this.
pub const GOAL_SCALE: f32 = 0.2;

/// Fields of the floating-point state, `real[field * envs + env]`.
pub mod real {
    /// Root on the ground, m.
    pub const X: usize = 0;
    pub const Z: usize = 1;
    /// Unit forward direction.
    pub const HEADING_X: usize = 2;
    pub const HEADING_Z: usize = 3;
    /// Target on the ground, m.
    pub const TARGET_X: usize = 4;
    pub const TARGET_Z: usize = 5;
    /// Rewards of the running episode.
    pub const RETURN: usize = 6;
    /// Metres walked in the running episode.
    pub const TRAVELLED: usize = 7;
    /// Summed returns of the episodes ended since the last tally.
    pub const RETURNS: usize = 8;
    pub const FIELDS: usize = 9;
}

/// Fields of the integer state, `whole[field * envs + env]`.
pub mod whole {
    /// Database frame now shown.
    pub const FRAME: usize = 0;
    /// Steps of the running episode.
    pub const AGE: usize = 1;
    /// Episodes ended since the last tally, those that succeeded, and their steps.
    pub const EPISODES: usize = 2;
    pub const SUCCESSES: usize = 3;
    pub const LENGTHS: usize = 4;
    pub const FIELDS: usize = 5;
}

/// How a step ends.
pub mod end {
    pub const RUNNING: u32 = 0;
    /// The target was reached: terminal.
    pub const REACHED: u32 = 1;
    /// Out of steps: not terminal, bootstrapped with the value of the last real state.
    pub const TRUNCATED: u32 = 2;
}

const _: () = {
    assert!(wgsl::POSE as usize == POSE && wgsl::TRAJECTORY as usize == TRAJECTORY);
    assert!(wgsl::FEATURE as usize == FEATURE && wgsl::QUADS as usize * 4 == PADDED);
    assert!(wgsl::OBSERVATION as usize == OBSERVATION && wgsl::PLAYED as usize == PLAYED);
    assert!(wgsl::X as usize == real::X && wgsl::Z as usize == real::Z);
    assert!(
        wgsl::HEADING_X as usize == real::HEADING_X && wgsl::HEADING_Z as usize == real::HEADING_Z
    );
    assert!(wgsl::TARGET_X as usize == real::TARGET_X && wgsl::TARGET_Z as usize == real::TARGET_Z);
    assert!(wgsl::RETURN as usize == real::RETURN && wgsl::TRAVELLED as usize == real::TRAVELLED);
    assert!(wgsl::RETURNS as usize == real::RETURNS && wgsl::REALS as usize == real::FIELDS);
    assert!(wgsl::FRAME as usize == whole::FRAME && wgsl::AGE as usize == whole::AGE);
    assert!(
        wgsl::EPISODES as usize == whole::EPISODES && wgsl::SUCCESSES as usize == whole::SUCCESSES
    );
    assert!(wgsl::LENGTHS as usize == whole::LENGTHS && wgsl::WHOLES as usize == whole::FIELDS);
    assert!(wgsl::RUNNING == end::RUNNING && wgsl::REACHED == end::REACHED);
    assert!(wgsl::TRUNCATED == end::TRUNCATED);
};
