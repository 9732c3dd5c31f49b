//! Where the bodies are, and which way each degree of freedom moves them.

use super::model::{Joint, Kind, Model};
use super::pose::Pose;
use super::spatial::Spatial;
use glam::{Quat, Vec3};

/// A quaternion of `q`, where w comes first.
#[inline]
pub fn quaternion(q: &[f32]) -> Quat {
    Quat::from_xyzw(q[1], q[2], q[3], q[0])
}

/// Writes a quaternion where [`quaternion`] reads it.
#[inline]
pub fn store(q: &mut [f32], turn: Quat) {
    q[..4].copy_from_slice(&[turn.w, turn.x, turn.y, turn.z]);
}

/// The point about which a tree's spatial vectors are taken: where its first body is, if that is
/// free, else where it is fastened.
#[inline]
pub fn origin(model: &Model, tree: usize, q: &[f32]) -> Vec3 {
    let root = &model.bodies[model.trees[tree].bodies.start];
    match model.joints[root.joints.clone()].first() {
        Some(joint) if joint.kind == Kind::Free => Vec3::from_slice(&q[joint.q..]),
        _ => root.place,
    }
}

/// World poses of all bodies, and the motion of every degree of freedom about its tree's origin.
///
/// `q` is `[positions]`; `poses` `[bodies]`; `axes` `[dofs]`.
#[inline]
pub fn kinematics(model: &Model, q: &[f32], poses: &mut [Pose], axes: &mut [Spatial]) {
    for (index, body) in model.bodies.iter().enumerate() {
        let fixed = Pose {
            place: body.place,
            turn: body.turn,
        };
        let mut pose = body.parent.map_or(fixed, |parent| poses[parent] * fixed);
        let origin = origin(model, body.tree, q);
        for joint in &model.joints[body.joints.clone()] {
            let anchor = pose.at(joint.place);
            let axis = pose.turn * joint.axis;
            pose = moved(pose, joint, q);
            swept(joint, &pose, anchor - origin, axis, axes);
        }
        pose.turn = pose.turn.normalize();
        poses[index] = pose;
    }
}

/// The body's pose behind its joint.
#[inline]
fn moved(pose: Pose, joint: &Joint, q: &[f32]) -> Pose {
    let at = &q[joint.q..];
    let turn = match joint.kind {
        Kind::Free => {
            return Pose {
                place: Vec3::new(at[0], at[1], at[2]),
                turn: quaternion(&at[3..]).normalize(),
            };
        }
        Kind::Ball => quaternion(at).normalize(),
        Kind::Hinge => Quat::from_axis_angle(joint.axis, at[0]),
    };
    let turned = pose.turn * turn;
    Pose {
        place: pose.at(joint.place) - turned * joint.place,
        turn: turned,
    }
}

/// Motions of a joint's degrees of freedom; `anchor` is seen from the origin.
#[inline]
fn swept(joint: &Joint, pose: &Pose, anchor: Vec3, axis: Vec3, axes: &mut [Spatial]) {
    let about = |axis: Vec3, anchor: Vec3| Spatial {
        angular: axis,
        linear: anchor.cross(axis),
    };
    let own = [Vec3::X, Vec3::Y, Vec3::Z];
    match joint.kind {
        Kind::Free => {
            for (k, axis) in own.into_iter().enumerate() {
                axes[joint.v + k] = Spatial {
                    angular: Vec3::ZERO,
                    linear: axis,
                };
                // A root turns about its own place, which is the origin.
                axes[joint.v + 3 + k] = about(pose.turn * axis, Vec3::ZERO);
            }
        }
        Kind::Ball => {
            for (k, axis) in own.into_iter().enumerate() {
                axes[joint.v + k] = about(pose.turn * axis, anchor);
            }
        }
        Kind::Hinge => axes[joint.v] = about(axis, anchor),
    }
}
