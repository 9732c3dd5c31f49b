//! Position and rotation of a frame as seen from another.

use glam::{Quat, Vec3};
use std::ops::Mul;

/// Rotation from the bodies' axes, z up, x forward, to those of recordings and pictures: y up, z forward.
pub const Y_UP: Quat = Quat::from_xyzw(-0.5, -0.5, -0.5, 0.5);

/// Position and rotation of a frame as seen from another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// m
    pub position: Vec3,
    /// Rotation from this frame to the outer one, a unit quaternion.
    pub rotation: Quat,
}

impl Pose {
    /// A point of this frame, seen from outside.
    #[inline]
    pub fn at(&self, point: Vec3) -> Vec3 {
        self.position + self.rotation * point
    }
}

impl Mul for Pose {
    type Output = Pose;
    #[inline]
    fn mul(self, inner: Pose) -> Pose {
        Pose {
            position: self.at(inner.position),
            rotation: self.rotation * inner.rotation,
        }
    }
}
