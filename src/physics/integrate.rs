//! One step forward: velocities first, then positions with the new velocities (semi-implicit Euler).

use super::kinematics::{quaternion, store};
use super::model::{JointKind, Model};
use glam::{Quat, Vec3};

/// Advances velocities, then positions, by a step of `dt` seconds.
#[inline]
pub fn integrate(model: &Model, acceleration: &[f32], dt: f32, q: &mut [f32], v: &mut [f32]) {
    for (v, a) in v.iter_mut().zip(acceleration) {
        *v += dt * a;
    }
    drift(model, v, dt, q);
}

/// Moves positions along velocities for `dt` seconds.
#[inline]
pub fn drift(model: &Model, v: &[f32], dt: f32, q: &mut [f32]) {
    for joint in &model.joints {
        let (q, v) = (&mut q[joint.q..], &v[joint.v..]);
        match joint.kind {
            JointKind::Hinge => q[0] += dt * v[0],
            JointKind::Ball => rotate(&mut q[..4], &v[..3], dt),
            JointKind::Free => {
                for axis in 0..3 {
                    q[axis] += dt * v[axis];
                }
                rotate(&mut q[3..7], &v[3..6], dt);
            }
        }
    }
}

/// Rotates a quaternion by an angular velocity in its own frame.
#[inline]
fn rotate(q: &mut [f32], v: &[f32], dt: f32) {
    let rotated = quaternion(q) * Quat::from_scaled_axis(Vec3::from_slice(v) * dt);
    store(q, rotated.normalize());
}
