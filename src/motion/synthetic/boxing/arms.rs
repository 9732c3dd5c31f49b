//! Two-joint arms: a shoulder and a fist in, rotations out.

use super::trunk::Trunk;
use crate::motion::synthetic::ease::level_off;
use crate::motion::synthetic::figure::{ARM, FORE_ARM, HAND, JOINTS, SIDE};
use glam::{Mat3, Quat, Vec3};

/// Lengths of the bones (m).
const UPPER: f32 = 0.28;
const FORE: f32 = 0.25;
pub const LENGTH: f32 = UPPER + FORE;
/// An arm levels off from this share of its length, and never gets beyond the other: an elbow is
/// never locked.
const STRETCH: (f32, f32) = (0.98, 0.994);
/// The shortest an arm folds (m): an elbow bends to at most about 145 degrees.
const SHORTEST: f32 = 0.165;

/// What an arm is to do.
pub struct Fist {
    pub at: Vec3,
    /// Which way the elbow points.
    pub elbow: Vec3,
    /// Turning of the palm down from where it faces in guard (rad).
    pub pronation: f32,
}

/// Writes the local rotations of an arm into `pose`.
pub fn reach(trunk: &Trunk, side: usize, fist: &Fist, pose: &mut [Quat; JOINTS]) {
    let span = fist.at - trunk.shoulders[side];
    let share = level_off(span.length() / LENGTH, STRETCH.0, STRETCH.1);
    let distance = (share * LENGTH).max(SHORTEST);
    let to_fist = span.normalize_or(Vec3::Z);
    let to_elbow = fist.elbow.reject_from(to_fist).normalize_or(Vec3::NEG_Y);

    let cos = |near: f32, far: f32, opposite: f32| {
        (near * near + far * far - opposite * opposite) / (2.0 * near * far)
    };
    let lift = cos(UPPER, distance, FORE).clamp(-1.0, 1.0);
    let rise = (1.0 - lift * lift).sqrt();
    let bone = to_fist * lift + to_elbow * rise;
    // The forearm folds towards the side away from the elbow.
    let folds = to_fist * rise - to_elbow * lift;
    let x = SIDE[side] * bone;
    let upper = Quat::from_mat3(&Mat3::from_cols(x, folds.cross(x), folds));
    let inner = cos(UPPER, FORE, distance).clamp(-1.0, 1.0);
    let fold = std::f32::consts::PI - inner.acos();

    pose[ARM[side]] = trunk.collars[side].inverse() * upper;
    pose[FORE_ARM[side]] = Quat::from_rotation_y(-SIDE[side] * fold);
    pose[HAND[side]] = Quat::from_rotation_x(fist.pronation);
}
