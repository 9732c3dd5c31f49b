//! Which way a person faces: by the toes, and by which side is left.

use super::bvh::Recording;
use super::roles::Roles;
use glam::Vec3;

/// Frames that are looked at, spread over the recording.
const SAMPLES: usize = 64;

/// Toes point backwards if they point against the front by this much.
const AGAINST: f32 = -0.5;

/// The sides are exchanged if the toes point backwards in nearly all frames.
const NEARLY_ALL: f32 = 0.9;

/// The fraction of the upright frames in which the toes point where the back should be, if it is nearly
/// all: then left and right are exchanged, in the names or in the world, as of programs with left-handed
/// axes. Y must be up, and the root the hips.
pub fn backwards(recording: &Recording, roles: &Roles) -> Option<f32> {
    let step = recording.frames().div_ceil(SAMPLES).max(1);
    let looked_at = (0..recording.frames()).step_by(step);
    let toes: Vec<f32> = looked_at
        .filter_map(|frame| toes(recording, roles, frame))
        .collect();
    let against = toes.iter().filter(|&&toes| toes < AGAINST).count();
    let share = against as f32 / toes.len().max(1) as f32;
    (share >= NEARLY_ALL).then_some(share)
}

/// How far forward the toes of who is upright point, from -1 to 1.
fn toes(recording: &Recording, roles: &Roles, frame: usize) -> Option<f32> {
    let (at, _) = recording.skeleton.world(Vec3::ZERO, recording.pose(frame));
    let [
        hips,
        left_hip,
        right_hip,
        left_foot,
        right_foot,
        left_toe,
        right_toe,
        left,
        right,
    ] = roles.joints().map(|joint| at[joint]);
    if left.y.min(right.y) < hips.y || left_foot.y.max(right_foot.y) > hips.y {
        return None;
    }
    let leftwards = left_hip - right_hip + left - right;
    let front = leftwards.cross(Vec3::Y).normalize_or_zero();
    let toes = left_toe - left_foot + right_toe - right_foot;
    Some(toes.with_y(0.0).normalize_or_zero().dot(front))
}
