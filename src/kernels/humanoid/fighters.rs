//! The bodies of two fighters in one world; `shaders/shared/fighters.wgsl` has the same functions.

use crate::kernels::physics::proprioception::heading_of;
use crate::physics::pose::Pose;
use crate::physics::spatial::Spatial;
use glam::{Vec2, Vec3};

/// Fighters of a world.
pub const FIGHTERS: usize = 2;

/// Which bodies of a fighter hit and are hit, counted from its first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FighterBodies {
    /// How many bodies it has.
    pub count: u32,
    /// Right and left hand.
    pub hands: [u32; 2],
    /// Torso and head.
    pub targets: [u32; 2],
    /// How far their centres are up their z axes, m.
    pub up: [f32; 2],
}

/// Both fighters at one moment: the bodies of the first, then those of the second.
pub struct Fighters<'a> {
    /// Which body is which.
    pub bodies: FighterBodies,
    /// `[bodies]`
    pub poses: &'a [Pose],
    /// About the origin of their tree, `[bodies]`.
    pub velocities: &'a [Spatial],
}

/// A point of a moving body, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMotion {
    /// m
    pub position: Vec3,
    /// m/s
    pub velocity: Vec3,
}

impl Fighters<'_> {
    /// Index of a fighter's root, from which its bodies are counted.
    pub fn root(&self, fighter: usize) -> usize {
        fighter * self.bodies.count as usize
    }

    /// Which way a fighter faces, a unit vector on the ground.
    pub fn heading(&self, fighter: usize) -> Vec2 {
        heading_of(self.poses[self.root(fighter)].rotation)
    }

    /// A fighter's right (0) or left (1) hand.
    pub fn hand(&self, fighter: usize, hand: usize) -> PointMotion {
        self.point(fighter, self.bodies.hands[hand], 0.0)
    }

    /// The centre of a fighter's torso (0) or head (1).
    pub fn target(&self, fighter: usize, part: usize) -> PointMotion {
        self.point(fighter, self.bodies.targets[part], self.bodies.up[part])
    }

    /// A point up the z axis of a fighter's body; the tree's velocities are where its root is.
    fn point(&self, fighter: usize, body: u32, up: f32) -> PointMotion {
        let root = self.root(fighter);
        let body = root + body as usize;
        let position = self.poses[body].at(Vec3::Z * up);
        let arm = position - self.poses[root].position;
        PointMotion {
            position,
            velocity: self.velocities[body].at(arm),
        }
    }
}
