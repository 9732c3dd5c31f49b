//! The pose of a whole character.

use crate::motion::skeleton::{JointTransforms, Skeleton};
use glam::{Quat, Vec3};

/// Position of the root in the world (m) and rotation of every joint relative to its parent; the root's
/// is relative to the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CharacterPose {
    /// Position of the root, m.
    pub root: Vec3,
    /// Rotation of every joint.
    pub rotations: Vec<Quat>,
}

impl CharacterPose {
    /// World positions (m) and rotations of every joint.
    pub fn world(&self, skeleton: &Skeleton) -> (Vec<Vec3>, Vec<Quat>) {
        skeleton.world(self.root, &self.rotations)
    }

    /// [`CharacterPose::world`] in memory that is there already.
    pub fn world_into(&self, skeleton: &Skeleton, world: &mut JointTransforms) {
        skeleton.world_into(self.root, &self.rotations, world);
    }
}
