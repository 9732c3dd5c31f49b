//! Stitching: what keeps a jump from one frame to another from being seen.

use super::inertialize::InertializedOffset;
use super::pose::CharacterPose;
use super::placed_frame::PlacedFrame;
use crate::motion::database::Database;
use glam::{Quat, Vec3};

/// Frames until nothing is left of a difference: long enough to hide a jump, short enough that the
/// recording is seen.
const FRAMES: f32 = 12.0;

/// How two pieces of motion are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stitching {
    /// They are not: the pose jumps.
    None,
    /// The difference of the poses fades away (the paper's "simple motion stitching").
    Simple,
    /// The difference fades away, beginning with its own velocity and acceleration
    /// (inertialization): the motion goes on as it was moving.
    Inertialization,
}

/// The fading difference between what is shown and what the recording says, of the root's place and
/// of every joint's rotation (as a rotation vector, in the parent's frame).
#[derive(Clone, Debug)]
pub struct Stitch {
    kind: Stitching,
    root: InertializedOffset,
    joints: Vec<InertializedOffset>,
    /// Frames since it began.
    age: f32,
}

impl Stitch {
    pub fn new(kind: Stitching, joints: usize) -> Self {
        Stitch {
            kind,
            root: InertializedOffset::default(),
            joints: vec![InertializedOffset::default(); joints],
            age: 0.0,
        }
    }

    /// A frame has passed.
    pub fn pass(&mut self) {
        self.age += 1.0;
    }

    /// The motion of `from`, just shown, goes over into that of `to`, next to be shown.
    pub fn turn(&mut self, database: &Database, from: PlacedFrame, to: PlacedFrame) {
        if self.kind == Stitching::None {
            return;
        }
        // What would have been shown, and what is recorded, a frame before, at and after the seam.
        let pairs = [0, 1, 2].map(|ahead: isize| {
            let mut old = from.on(database, ahead).pose(database);
            self.add(&mut old, self.age + ahead as f32 - 1.0);
            (old, to.on(database, ahead - 1).pose(database))
        });
        let fade = |difference: &dyn Fn(&CharacterPose, &CharacterPose) -> Vec3| {
            let [before, now, after] = [0, 1, 2].map(|at| difference(&pairs[at].0, &pairs[at].1));
            match self.kind {
                Stitching::Inertialization => InertializedOffset::through(before, now, after),
                _ => InertializedOffset {
                    value: now,
                    ..InertializedOffset::default()
                },
            }
        };
        let root = fade(&|old, new| old.root - new.root);
        let joints = (0..self.joints.len())
            .map(|joint| {
                fade(&|old, new| shortest(old.rotations[joint] * new.rotations[joint].inverse()))
            })
            .collect();
        (self.root, self.joints, self.age) = (root, joints, 0.0);
    }

    /// Adds what is left of the difference.
    pub fn apply(&self, pose: &mut CharacterPose) {
        if self.kind != Stitching::None {
            self.add(pose, self.age);
        }
    }

    fn add(&self, pose: &mut CharacterPose, age: f32) {
        pose.root += self.root.at(age, FRAMES);
        for (rotation, fade) in pose.rotations.iter_mut().zip(&self.joints) {
            *rotation = (Quat::from_scaled_axis(fade.at(age, FRAMES)) * *rotation).normalize();
        }
    }
}

/// The rotation vector of the shorter way round.
fn shortest(rotation: Quat) -> Vec3 {
    let near = if rotation.w < 0.0 {
        -rotation
    } else {
        rotation
    };
    near.to_scaled_axis()
}
