//! Mirrored motions: left and right exchanged.
//!
//! The world is reflected over y = 0. So is each body's own frame, which leaves a model as it is whose
//! left and right bodies are each other's reflection.

use super::model::{Joint, JointKind, Model};
use super::motion_clip::MotionClip;
use glam::Vec3;

/// A body whose counterpart on the other side is missing or has other joints.
#[derive(Debug, thiserror::Error)]
#[error(
    "the model '{model}' cannot be mirrored: the joints of its body '{body}' are not those of a body '{other}'. Give it one, or leave its motions unmirrored"
)]
pub struct MirrorError {
    /// Name of the model.
    pub model: String,
    /// Name of the body.
    pub body: String,
    /// Name that its counterpart would have.
    pub other: String,
}

/// The mirrored copy of a motion: the left side does what the right one did and the reverse, reflected
/// over y = 0. Mirroring twice gives the motion back.
///
/// # Errors
/// A body `left_...` or `right_...` of the model without a counterpart.
pub fn mirrored(model: &Model, clip: &MotionClip) -> Result<MotionClip, MirrorError> {
    let pairs = pairs(model)?;
    let (mut q, mut v) = (clip.q.clone(), clip.v.clone());
    for frame in 0..clip.frames {
        let q = &mut q[frame * model.nq()..][..model.nq()];
        let v = &mut v[frame * model.nv()..][..model.nv()];
        for (joint, other) in model.joints.iter().zip(&pairs) {
            reflect_positions(joint, other, clip.q(frame), q);
            reflect_velocities(joint, other, clip.v(frame), v);
        }
    }
    Ok(MotionClip {
        q,
        v,
        ..clip.clone()
    })
}

/// For each joint its counterpart on the other side; a joint of the middle is its own.
fn pairs(model: &Model) -> Result<Vec<&Joint>, MirrorError> {
    let mut pairs = Vec::with_capacity(model.joints.len());
    for body in &model.bodies {
        let name = other_side(&body.name);
        let other = model.body(&name).map(|other| &model.bodies[other]);
        let other = other.map_or(&[][..], |other| &model.joints[other.joints.clone()]);
        let own = &model.joints[body.joints.clone()];
        let alike = own.len() == other.len()
            && own.iter().zip(other).all(|(own, other)| {
                own.kind == other.kind
                    && reflected(own.axis).abs_diff_eq(other.axis * turn(own, other), 1e-4)
            });
        if !alike {
            return Err(MirrorError {
                model: model.name.clone(),
                body: body.name.clone(),
                other: name,
            });
        }
        pairs.extend(other);
    }
    Ok(pairs)
}

/// A body's name with its side exchanged.
fn other_side(name: &str) -> String {
    match name.contains("left_") {
        true => name.replacen("left_", "right_", 1),
        false => name.replacen("right_", "left_", 1),
    }
}

/// A rotation's axis, reflected over y = 0.
fn reflected(axis: Vec3) -> Vec3 {
    Vec3::new(-axis.x, axis.y, -axis.z)
}

/// Which way a hinge turns when its counterpart turns forwards.
fn turn(joint: &Joint, other: &Joint) -> f32 {
    1.0f32.copysign(reflected(joint.axis).dot(other.axis))
}

fn reflect_positions(joint: &Joint, other: &Joint, from: &[f32], to: &mut [f32]) {
    let (from, to) = (&from[other.q..], &mut to[joint.q..]);
    match joint.kind {
        JointKind::Hinge => to[0] = turn(joint, other) * from[0],
        JointKind::Ball => to[..4].copy_from_slice(&reflect_quaternion(from)),
        JointKind::Free => {
            to[..3].copy_from_slice(&[from[0], -from[1], from[2]]);
            to[3..7].copy_from_slice(&reflect_quaternion(&from[3..]));
        }
    }
}

fn reflect_velocities(joint: &Joint, other: &Joint, from: &[f32], to: &mut [f32]) {
    let (from, to) = (&from[other.v..], &mut to[joint.v..]);
    let angular = |v: &[f32]| reflected(Vec3::from_slice(v)).to_array();
    match joint.kind {
        JointKind::Hinge => to[0] = turn(joint, other) * from[0],
        JointKind::Ball => to[..3].copy_from_slice(&angular(from)),
        JointKind::Free => {
            to[..3].copy_from_slice(&[from[0], -from[1], from[2]]);
            to[3..6].copy_from_slice(&angular(&from[3..]));
        }
    }
}

/// A quaternion of positions, w first, reflected over y = 0.
fn reflect_quaternion(q: &[f32]) -> [f32; 4] {
    [q[0], -q[1], q[2], -q[3]]
}
