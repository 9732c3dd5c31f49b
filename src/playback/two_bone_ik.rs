//! Analytic two-bone inverse kinematics: hip and knee are rotated so that the foot comes to a point.

use super::leg::LegJoints;
use super::pose::CharacterPose;
use crate::motion::skeleton::{JointTransforms, Skeleton};
use glam::{Quat, Vec3};

/// From this fraction of its length on, a leg is stretched ever more slowly, so that the knee does not
/// snap straight.
const SOFT: f32 = 0.985;
/// Knees bent less than this (as a sine) take their axis from the leg, not from the pose.
const STRAIGHT: f32 = 0.2;

/// Brings the ankle to `target` (world, m), or as near as the leg reaches, keeping the foot's rotation
/// in the world and the direction of the knee. `world` is memory for the joints of the pose.
pub fn solve(
    skeleton: &Skeleton,
    pose: &mut CharacterPose,
    leg: &LegJoints,
    target: Vec3,
    world: &mut JointTransforms,
) {
    if leg.knee == leg.hip {
        return;
    }
    pose.world_into(skeleton, world);
    let (at, turned) = (&world.positions, &world.rotations);
    let (hip, knee, foot) = (at[leg.hip], at[leg.knee], at[leg.foot]);
    let (thigh, shank) = (knee - hip, foot - knee);
    let (long, short) = (thigh.length(), shank.length());
    let wanted = (target - hip).length();
    if wanted < 1e-4 || long < 1e-4 || short < 1e-4 {
        return;
    }
    let distance = stretch(wanted, foot.distance(hip), long, short);

    // Flexion: the angle from the thigh's direction to the shank's, about the knee's axis.
    let axis = knee_axis(thigh, shank, turned[leg.hip] * leg.axis);
    let flexed = thigh.angle_between(shank) * axis.dot(thigh.cross(shank)).signum();
    let cosine = (distance * distance - long * long - short * short) / (2.0 * long * short);
    let flex = Quat::from_axis_angle(axis, cosine.clamp(-1.0, 1.0).acos() - flexed);
    // Then the whole leg is swung to the target.
    let swing = arc(thigh + flex * shank, target - hip);

    let parent = |joint: usize| skeleton.parents[joint].map_or(Quat::IDENTITY, |p| turned[p]);
    let (above_hip, above_knee, above_foot) = (parent(leg.hip), parent(leg.knee), parent(leg.foot));
    let rotations = &mut pose.rotations;
    rotations[leg.hip] = (above_hip.inverse() * swing * turned[leg.hip]).normalize();
    rotations[leg.knee] = (above_knee.inverse() * flex * turned[leg.knee]).normalize();
    rotations[leg.foot] = ((swing * flex * above_foot).inverse() * turned[leg.foot]).normalize();
}

/// Distance by which the hip has to come down for a leg of that `length` to bring the ankle from `foot` to
/// `target`, m. `None` if the target is farther than the leg's length from the point below the hip.
pub fn shortfall(hip: Vec3, foot: Vec3, target: Vec3, length: f32) -> Option<f32> {
    let reach = (SOFT * length).max(foot.distance(hip));
    let away = (target.x - hip.x).hypot(target.z - hip.z);
    let height = (reach * reach - away * away).max(0.0).sqrt();
    (away < reach).then(|| (hip.y - target.y - height).max(0.0))
}

/// The hip-to-ankle distance to take: the requested one, if it is no farther than now or well within
/// the leg's length.
fn stretch(wanted: f32, now: f32, long: f32, short: f32) -> f32 {
    let (most, least) = (long + short, (long - short).abs());
    let soft = SOFT * most;
    let room = most - soft;
    let eased = match wanted > soft {
        true => soft + room * (1.0 - ((soft - wanted) / room).exp()),
        false => wanted,
    };
    eased.max(wanted.min(now)).clamp(least, most)
}

/// The axis at right angles to thigh and shank; of a nearly straight leg, the leg's own.
fn knee_axis(thigh: Vec3, shank: Vec3, own: Vec3) -> Vec3 {
    let normal = thigh.normalize().cross(shank.normalize());
    let along = (thigh + shank).normalize_or(thigh);
    let own = own
        .reject_from(along)
        .normalize_or(own.any_orthonormal_vector());
    let weight = (1.0 - normal.length() / STRAIGHT).max(0.0);
    // Weighted, so that nothing jumps where the pose takes over.
    (normal / STRAIGHT + own * weight).normalize_or(own)
}

/// The smallest rotation that takes one direction to another.
fn arc(from: Vec3, to: Vec3) -> Quat {
    Quat::from_rotation_arc(from.normalize(), to.normalize())
}
