//! Two-joint legs: hips and ankles in, thigh and shin rotations out.

use super::ease::{mix, smooth};
use super::figure::{SHIN, THIGH};
use glam::{Mat3, Quat, Vec3};

/// A leg carries weight up to this share of its full length, and never gets beyond `LONGEST`:
/// the knee always keeps a bend.
pub const STRAIGHT: f32 = 0.992;
const LONGEST: f32 = 0.998;
/// A swinging leg begins to level off here: it does not snap straight before it lands.
const EASY: f32 = 0.88;
/// The shortest a leg folds (m): the knee bends to at most about 140 degrees.
const SHORTEST: f32 = 0.3;

/// World rotations of a leg.
pub struct Leg {
    pub thigh: Quat,
    pub shin: Quat,
}

/// The share of its length that a leg shows where `share` is requested of it: equal up to a limit,
/// then levelling off below [`LONGEST`]. In the `air` (0..1) it levels off from earlier on.
fn reach(share: f32, air: f32) -> f32 {
    let limit = mix(STRAIGHT, EASY, air);
    let room = LONGEST - limit;
    if share <= limit {
        share
    } else {
        LONGEST - room * ((limit - share) / room).exp()
    }
}

/// Bends the leg from `hip` towards `ankle` with the knee hinge along `sideways` (to the left);
/// `air` as for a [`FootState`](super::feet::FootState).
pub fn bend(hip: Vec3, ankle: Vec3, sideways: Vec3, air: f32) -> Leg {
    let full = THIGH + SHIN;
    let span = ankle - hip;
    let distance = (full * reach(span.length() / full, air)).max(SHORTEST);
    let down = span.normalize_or(Vec3::NEG_Y);
    let hinge = (sideways - down * sideways.dot(down)).normalize_or(Vec3::X);
    let forward = down.cross(hinge);
    let cos = (THIGH * THIGH + distance * distance - SHIN * SHIN) / (2.0 * THIGH * distance);
    let cos = cos.clamp(-1.0, 1.0);
    let knee = THIGH * (down * cos + forward * (1.0 - cos * cos).sqrt());
    Leg {
        thigh: along(knee, hinge),
        shin: along(down * distance - knee, hinge),
    }
}

/// The rotation that takes -y to `bone` and x to `hinge`.
fn along(bone: Vec3, hinge: Vec3) -> Quat {
    let y = -bone.normalize();
    Quat::from_mat3(&Mat3::from_cols(hinge, y, hinge.cross(y)))
}

/// How much lower than `height` (m over the ankle) a hip must be for a loaded leg to reach
/// `aside` metres over the ground.
pub fn overreach(height: f32, aside: f32) -> f32 {
    let leg = STRAIGHT * (THIGH + SHIN);
    let flat = aside.min(0.8 * leg);
    (height - (leg * leg - flat * flat).sqrt()).max(0.0)
}

/// A smooth curve nowhere below `needs`: the largest need nearby, averaged over a window as
/// wide, twice.
pub fn envelope(needs: &[f32], window: usize) -> Vec<f32> {
    let highest = filtered(needs, 2 * window, |near| {
        near.iter().fold(0.0, |a, &b| a.max(b))
    });
    let mean = |near: &[f32]| near.iter().sum::<f32>() / near.len() as f32;
    filtered(&filtered(&highest, window, mean), window, mean)
}

fn filtered(values: &[f32], reach: usize, of: impl Fn(&[f32]) -> f32) -> Vec<f32> {
    (0..values.len())
        .map(|i| of(&values[i.saturating_sub(reach)..(i + reach + 1).min(values.len())]))
        .collect()
}

/// The knees point between the hips' and the foot's forward.
pub fn hinge(pelvis: Quat, foot: Quat) -> Vec3 {
    let (hips, toes) = (pelvis * Vec3::X, foot * Vec3::X);
    hips.lerp(toes, 0.5 * smooth(-0.5, 0.5, hips.dot(toes)))
}
