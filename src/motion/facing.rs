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

/// The fraction of the frames in which the toes point where the back should be, if it is nearly all: then
/// left and right are exchanged, in the names or in the world, as of programs with left-handed axes. Y
/// must be up, and the root the hips.
pub fn backwards(recording: &Recording, roles: &Roles) -> Option<f32> {
    let skeleton = &recording.skeleton;
    let step = recording.frames().div_ceil(SAMPLES).max(1);
    let frames = (0..recording.frames()).step_by(step);
    let mut against = 0;
    let looked_at = frames.len();
    for frame in frames {
        let (at, _) = skeleton.world(Vec3::ZERO, recording.pose(frame));
        let [
            _,
            left_hip,
            right_hip,
            left_foot,
            right_foot,
            left_toe,
            right_toe,
            left,
            right,
        ] = roles.joints().map(|joint| at[joint].with_y(0.0));
        let leftwards = left_hip - right_hip + left - right;
        let front = leftwards.cross(Vec3::Y).normalize_or_zero();
        let toes = (left_toe - left_foot + right_toe - right_foot).normalize_or_zero();
        against += usize::from(toes.dot(front) < AGAINST);
    }
    let share = against as f32 / looked_at.max(1) as f32;
    (share >= NEARLY_ALL).then_some(share)
}
