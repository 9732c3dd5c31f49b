//! Two-joint legs: hips and ankles in, thigh and shin rotations out.

use super::ease::{level_off, mix, smooth};
use super::feet::FootState;
use super::figure::{self, FOOT, JOINTS, LEG, SHIN, THIGH, TOE, UP_LEG};
use glam::{Mat3, Quat, Vec3};

/// A leg carries weight up to this share of its full length, and never gets beyond `LONGEST`:
/// the knee always keeps a bend.
const STRAIGHT: f32 = 0.992;
const LONGEST: f32 = 0.998;
/// A swinging leg begins to level off here: it does not snap straight before it lands.
const EASY: f32 = 0.88;
/// The shortest a leg folds (m): the knee bends to at most about 140 degrees.
const SHORTEST: f32 = 0.3;
/// Frames over which the hips prepare for, and recover from, a long reach of a leg.
const REACH_WINDOW: usize = 3;

/// World rotations of a leg.
struct Leg {
    thigh: Quat,
    shin: Quat,
}

/// The share of its length that a leg shows where `share` is requested of it. In the `air` (0..1)
/// it levels off from earlier on.
fn reach(share: f32, air: f32) -> f32 {
    level_off(share, mix(STRAIGHT, EASY, air), LONGEST)
}

/// Writes the local rotations of legs that join the hips, at `position`, to the feet into `pose`,
/// whose root rotation is the hips'.
pub fn join(position: Vec3, feet: &[FootState; 2], pose: &mut [Quat; JOINTS]) {
    let rotation = pose[figure::HIPS];
    for (side, foot) in feet.iter().enumerate() {
        let hip = position + rotation * figure::hip(side);
        let hinge = hinge(rotation, foot.rotation);
        let leg = bend(hip, foot.ankle, hinge, foot.air);
        pose[UP_LEG[side]] = rotation.inverse() * leg.thigh;
        pose[LEG[side]] = leg.thigh.inverse() * leg.shin;
        pose[FOOT[side]] = leg.shin.inverse() * foot.rotation;
        pose[TOE[side]] = Quat::from_rotation_x(-foot.bend);
    }
}

/// Lowers the hips, smoothly, wherever a loaded leg would not reach its foot.
pub fn lower(pelvis: &mut [(Vec3, Quat)], feet: &[[FootState; 2]]) {
    let needs: Vec<f32> = pelvis
        .iter()
        .zip(feet)
        .map(|(&(position, rotation), feet)| {
            let need = |side: usize| {
                let span = position + rotation * figure::hip(side) - feet[side].ankle;
                overreach(span.y, span.x.hypot(span.z))
            };
            let loaded = (0..2).filter(|&side| feet[side].air == 0.0);
            loaded.map(need).fold(0.0, f32::max)
        })
        .collect();
    for ((position, _), by) in pelvis.iter_mut().zip(envelope(&needs, REACH_WINDOW)) {
        position.y -= by;
    }
}

/// Bends the leg from `hip` towards `ankle` with the knee hinge along `sideways` (to the left);
/// `air` as for a [`FootState`](super::feet::FootState).
fn bend(hip: Vec3, ankle: Vec3, sideways: Vec3, air: f32) -> Leg {
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
fn overreach(height: f32, aside: f32) -> f32 {
    let leg = STRAIGHT * (THIGH + SHIN);
    let flat = aside.min(0.8 * leg);
    (height - (leg * leg - flat * flat).sqrt()).max(0.0)
}

/// A smooth curve nowhere below `needs`: the largest need nearby, averaged over a window as
/// wide, twice.
fn envelope(needs: &[f32], window: usize) -> Vec<f32> {
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
fn hinge(pelvis: Quat, foot: Quat) -> Vec3 {
    let (hips, toes) = (pelvis * Vec3::X, foot * Vec3::X);
    hips.lerp(toes, 0.5 * smooth(-0.5, 0.5, hips.dot(toes)))
}
