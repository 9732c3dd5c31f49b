//! Layout of the index and bounds, shared by the twins of the search by the index.
//! Shader: `shaders/shared/search_index.wgsl`.

use crate::gpu::shader::search_seed::constants;
use crate::motion::features::{FEATURE_DIM, ROW_STRIDE, TRAJECTORY_DIM};

/// Rows a leaf.
pub const LEAF: usize = constants::LEAF as usize;
/// Leaves a group.
pub const GROUP: usize = constants::GROUP as usize;
/// Numbers kept of a query: along the twelve principal axes, and its slack.
pub const PROJECTION_LEN: usize = constants::PROJECTION_LEN as usize;
/// Invocations that compare a query's rows.
pub const LANES: usize = constants::LANES as usize;

/// Lower and upper corner of a box (0: the first group's) behind the axes.
pub fn corners(boxes: &[[f32; TRAJECTORY_DIM]], at: usize) -> &[[f32; TRAJECTORY_DIM]] {
    &boxes[TRAJECTORY_DIM + 2 * at..][..2]
}

/// Squared distance of a trajectory along the axes to a box, on top of what is known of the pose.
pub fn bound(
    corners: &[[f32; TRAJECTORY_DIM]],
    projected: &[f32; TRAJECTORY_DIM],
    pose: f32,
) -> f32 {
    let each = corners[0].iter().zip(&corners[1]).zip(projected);
    each.fold(pose, |sum, ((low, high), value)| {
        let outside = (low - value).max(value - high).max(0.0);
        outside.mul_add(outside, sum)
    })
}

/// The block of frames that a frame belongs to.
pub fn block_of(distance_codes: &[u8], frame: u32) -> usize {
    let bytes = &distance_codes[4 * frame as usize..][..4];
    u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as usize
}

/// Square of a distance given as a byte.
pub fn square(code: u8, step: f32) -> f32 {
    let distance = f32::from(code) * step;
    distance * distance
}

/// Bound beyond which nothing is nearer than this squared distance, or as near.
pub fn limit(squared: f32, slack: f32) -> f32 {
    match squared >= 1e37 {
        true => f32::MAX,
        false => (squared.sqrt() * 1.00001 + slack).powi(2),
    }
}

/// Replaces the best by a row if that is nearer, or as near and lower.
pub fn offer(row: &[f32; ROW_STRIDE], squared: f32, distance: &mut f32, candidate: &mut u32) {
    let found = row[FEATURE_DIM] as u32;
    if squared < *distance || (squared == *distance && found < *candidate) {
        (*distance, *candidate) = (squared, found);
    }
}
