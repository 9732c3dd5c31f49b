//! A tree of joints with fixed bone offsets.

use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

/// Joints in an order in which every parent precedes its children; joint 0 is the root.
///
/// Offsets are in metres, in the parent joint's frame, y up, the character facing +z in the
/// common conventions (so its left side is +x). The root's own offset is not used: a
/// [`Clip`](super::clip::Clip) gives the root's position for every frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Skeleton {
    /// Names of the joints.
    pub names: Vec<String>,
    /// `None` for joint 0 only.
    pub parents: Vec<Option<usize>>,
    /// Position of each joint relative to its parent, m.
    pub offsets: Vec<Vec3>,
    /// Tips of the leaf bones (BVH "End Site"): the joint they hang on and their offset in metres.
    pub ends: Vec<(usize, Vec3)>,
}

impl Skeleton {
    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.names.len()
    }

    /// Whether the lists fit together and every parent precedes its children.
    pub fn is_tree(&self) -> bool {
        let joints = self.joints();
        let parents = self.parents.iter().enumerate();
        self.parents.len() == joints
            && self.offsets.len() == joints
            && self.ends.iter().all(|&(joint, _)| joint < joints)
            && parents.fold(joints > 0, |tree, (joint, parent)| {
                tree && parent.map_or(joint == 0, |parent| parent < joint)
            })
    }

    /// Same joints under the same parents; bone lengths may differ (subjects of one capture).
    pub fn same_tree(&self, other: &Skeleton) -> bool {
        self.names == other.names && self.parents == other.parents
    }

    /// Summed bone lengths from `low` up to its ancestor `high`: their distance when stretched.
    pub fn reach(&self, high: usize, low: usize) -> f32 {
        std::iter::successors(Some(low), |&joint| self.parents[joint])
            .take_while(|&joint| joint != high)
            .map(|joint| self.offsets[joint].length())
            .sum()
    }

    /// Forward kinematics of one frame: world positions (m) and rotations of every joint.
    /// `rotations` are local, one a joint; `root` is the root joint's world position.
    pub fn world(&self, root: Vec3, rotations: &[Quat]) -> (Vec<Vec3>, Vec<Quat>) {
        let mut world = JointTransforms::default();
        self.world_into(root, rotations, &mut world);
        (world.positions, world.rotations)
    }

    /// [`Skeleton::world`] in memory that is there already.
    pub fn world_into(&self, root: Vec3, rotations: &[Quat], world: &mut JointTransforms) {
        let JointTransforms {
            positions,
            rotations: world,
        } = world;
        positions.clear();
        world.clear();
        for (joint, &local) in rotations.iter().enumerate().take(self.joints()) {
            match self.parents[joint] {
                None => {
                    positions.push(root);
                    world.push(local);
                }
                Some(parent) => {
                    positions.push(positions[parent] + world[parent] * self.offsets[joint]);
                    world.push((world[parent] * local).normalize());
                }
            }
        }
    }
}

/// World positions (m) and rotations of every joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointTransforms {
    /// Positions, m.
    pub positions: Vec<Vec3>,
    /// Rotations.
    pub rotations: Vec<Quat>,
}
