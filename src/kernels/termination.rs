//! How a step ends for an agent; `shaders/shared/termination.wgsl` has the same numbers.

use crate::gpu::shader::gae::constants as wgsl;

/// The episode goes on.
pub const RUNNING: u32 = 0;
/// The task is done: a target reached.
pub const SUCCESS: u32 = 1;
/// Out of steps: the value of the final observation goes on.
pub const TRUNCATED: u32 = 2;
/// The task has failed: a collision, a fall.
pub const FAILED: u32 = 3;
/// Added to how a step ends for a task: an agent whose episode would be won if it ended now.
pub const LEADS: u32 = 4;
/// The set of all of them; a set has the bit `1 << termination` for each.
pub const ANY: u32 = u32::MAX;

/// How a step would have ended so that new episodes begin where `which` says.
pub fn restarted(which: &[bool]) -> Vec<u32> {
    let end = |&restart: &bool| if restart { TRUNCATED } else { RUNNING };
    which.iter().map(end).collect()
}

const _: () = assert!(
    wgsl::RUNNING == RUNNING
        && wgsl::SUCCESS == SUCCESS
        && wgsl::TRUNCATED == TRUNCATED
        && wgsl::FAILED == FAILED
        && wgsl::LEADS == LEADS
);
