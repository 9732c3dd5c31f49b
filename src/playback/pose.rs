//! A whole body at one moment.

use crate::motion::skeleton::Skeleton;
use glam::{Quat, Vec3};

/// Where the root is in the world (m) and how every joint is turned against its parent; the root's
/// own rotation is the world's.
#[derive(Clone, Debug, PartialEq)]
pub struct CharacterPose {
    pub root: Vec3,
    pub rotations: Vec<Quat>,
}

impl CharacterPose {
    /// World positions (m) and rotations of every joint.
    pub fn world(&self, skeleton: &Skeleton) -> (Vec<Vec3>, Vec<Quat>) {
        skeleton.world(self.root, &self.rotations)
    }
}
