//! Where the bodies are, and which way each degree of freedom moves them.

use super::model::{Joint, JointKind, Model};
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
pub fn store(q: &mut [f32], rotation: Quat) {
    q[..4].copy_from_slice(&[rotation.w, rotation.x, rotation.y, rotation.z]);
}

/// The point about which a tree's spatial vectors are taken: where its first body is, if that is
/// free, else where it is fastened.
#[inline]
pub fn origin(model: &Model, tree: usize, q: &[f32]) -> Vec3 {
    let root = &model.bodies[model.trees[tree].bodies.start];
    match model.joints[root.joints.clone()].first() {
        Some(joint) if joint.kind == JointKind::Free => Vec3::from_slice(&q[joint.q..]),
        _ => root.position,
    }
}

/// Poses of the bodies at positions `q`, `[nq]`.
pub fn poses(model: &Model, q: &[f32]) -> Vec<Pose> {
    let mut poses = vec![Pose::default(); model.bodies.len()];
    let mut axes = vec![Spatial::ZERO; model.nv()];
    kinematics(model, q, &mut poses, &mut axes);
    poses
}

/// World poses of all bodies, and the motion of every degree of freedom about its tree's origin.
///
/// `q` is `[positions]`; `poses` `[bodies]`; `axes` `[dofs]`.
#[inline]
pub fn kinematics(model: &Model, q: &[f32], poses: &mut [Pose], axes: &mut [Spatial]) {
    for (index, body) in model.bodies.iter().enumerate() {
        let fixed = Pose {
            position: body.position,
            rotation: body.rotation,
        };
        let mut pose = body.parent.map_or(fixed, |parent| poses[parent] * fixed);
        let origin = origin(model, body.tree, q);
        for joint in &model.joints[body.joints.clone()] {
            let anchor = pose.at(joint.position);
            let axis = pose.rotation * joint.axis;
            pose = moved(pose, joint, q);
            swept(joint, &pose, anchor - origin, axis, axes);
        }
        pose.rotation = pose.rotation.normalize();
        poses[index] = pose;
    }
}

/// Velocities of all bodies, `[bodies]`, about their trees' origins, from those of the degrees of
/// freedom.
#[inline]
pub fn velocities(model: &Model, v: &[f32], axes: &[Spatial], velocities: &mut [Spatial]) {
    for (index, body) in model.bodies.iter().enumerate() {
        let mut velocity = body
            .parent
            .map_or(Spatial::ZERO, |parent| velocities[parent]);
        for dof in body.dofs.clone() {
            velocity += axes[dof] * v[dof];
        }
        velocities[index] = velocity;
    }
}

/// The body's pose behind its joint.
#[inline]
fn moved(pose: Pose, joint: &Joint, q: &[f32]) -> Pose {
    let at = &q[joint.q..];
    let rotation = match joint.kind {
        JointKind::Free => {
            return Pose {
                position: Vec3::new(at[0], at[1], at[2]),
                rotation: quaternion(&at[3..]).normalize(),
            };
        }
        JointKind::Ball => quaternion(at).normalize(),
        JointKind::Hinge => Quat::from_axis_angle(joint.axis, at[0]),
    };
    let turned = pose.rotation * rotation;
    Pose {
        position: pose.at(joint.position) - turned * joint.position,
        rotation: turned,
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
        JointKind::Free => {
            for (k, axis) in own.into_iter().enumerate() {
                axes[joint.v + k] = Spatial {
                    angular: Vec3::ZERO,
                    linear: axis,
                };
                // A root rotates about its own position, which is the origin.
                axes[joint.v + 3 + k] = about(pose.rotation * axis, Vec3::ZERO);
            }
        }
        JointKind::Ball => {
            for (k, axis) in own.into_iter().enumerate() {
                axes[joint.v + k] = about(pose.rotation * axis, anchor);
            }
        }
        JointKind::Hinge => axes[joint.v] = about(axis, anchor),
    }
}
