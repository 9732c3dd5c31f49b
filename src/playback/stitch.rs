//! Stitching: hides the jump from one frame of the database to another.

use super::inertialize::InertializedOffset;
use super::placed_frame::PlacedFrame;
use super::pose::CharacterPose;
use crate::motion::database::Database;
use glam::{Quat, Vec3};

/// Frames until an offset has decayed: long enough to hide a jump, short enough that the
/// recording is seen.
const FRAMES: f32 = 12.0;

/// How the poses before and after a jump are blended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stitching {
    /// They are not: the pose jumps.
    None,
    /// Linear blend: the difference of the poses decays (the paper's "simple motion stitching").
    Linear,
    /// Inertialization: the difference decays from its own velocity and acceleration, so that the motion
    /// goes on as it was moving.
    Inertialize,
}

/// The decaying difference between the shown pose and the recorded one: of the root's position and of
/// every joint's rotation (as a rotation vector, in the parent's frame).
#[derive(Clone, Debug)]
pub struct Stitch {
    kind: Stitching,
    root: InertializedOffset,
    joints: Vec<InertializedOffset>,
    /// Frames since it began.
    age: f32,
}

impl Stitch {
    /// No offset so far.
    pub fn new(kind: Stitching, joints: usize) -> Self {
        Stitch {
            kind,
            root: InertializedOffset::default(),
            joints: vec![InertializedOffset::default(); joints],
            age: 0.0,
        }
    }

    /// Moves on by a frame.
    pub fn advance(&mut self) {
        self.age += 1.0;
    }

    /// Begins to blend from the motion of `from`, just shown, to that of `to`, shown next.
    pub fn begin(&mut self, database: &Database, from: PlacedFrame, to: PlacedFrame) {
        if self.kind == Stitching::None {
            return;
        }
        // The poses on from `from` and those around `to`: a frame before, at and after the jump.
        let pairs = [0, 1, 2].map(|ahead: isize| {
            let mut old = from.on(database, ahead).pose(database);
            self.add(&mut old, self.age + ahead as f32 - 1.0);
            (old, to.on(database, ahead - 1).pose(database))
        });
        let offset = |difference: &dyn Fn(&CharacterPose, &CharacterPose) -> Vec3| {
            let [before, now, after] = [0, 1, 2].map(|at| difference(&pairs[at].0, &pairs[at].1));
            match self.kind {
                Stitching::Inertialize => InertializedOffset::through(before, now, after),
                _ => InertializedOffset {
                    value: now,
                    ..InertializedOffset::default()
                },
            }
        };
        let root = offset(&|old, new| old.root - new.root);
        let joints = (0..self.joints.len())
            .map(|joint| {
                offset(&|old, new| shortest(old.rotations[joint] * new.rotations[joint].inverse()))
            })
            .collect();
        (self.root, self.joints, self.age) = (root, joints, 0.0);
    }

    /// Adds the offsets that are left.
    pub fn apply(&self, pose: &mut CharacterPose) {
        if self.kind != Stitching::None {
            self.add(pose, self.age);
        }
    }

    fn add(&self, pose: &mut CharacterPose, age: f32) {
        pose.root += self.root.at(age, FRAMES);
        for (rotation, offset) in pose.rotations.iter_mut().zip(&self.joints) {
            *rotation = (Quat::from_scaled_axis(offset.at(age, FRAMES)) * *rotation).normalize();
        }
    }
}

/// The rotation vector of the shorter way round.
fn shortest(rotation: Quat) -> Vec3 {
    let shortest = if rotation.w < 0.0 {
        -rotation
    } else {
        rotation
    };
    shortest.to_scaled_axis()
}
