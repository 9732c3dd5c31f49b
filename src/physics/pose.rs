//! A place and a turn: a frame seen from another.

use glam::{Quat, Vec3};
use std::ops::Mul;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// m
    pub place: Vec3,
    pub turn: Quat,
}

impl Pose {
    /// A point of this frame, seen from outside.
    #[inline]
    pub fn at(&self, point: Vec3) -> Vec3 {
        self.place + self.turn * point
    }
}

impl Mul for Pose {
    type Output = Pose;
    #[inline]
    fn mul(self, inner: Pose) -> Pose {
        Pose {
            place: self.at(inner.place),
            turn: self.turn * inner.turn,
        }
    }
}
