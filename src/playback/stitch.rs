//! Stitching: hides the jump from one frame of the database to another.

use super::inertialize::InertializedOffset;
use super::placed_frame::{PlacedFrame, recorded};
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
        // The frames on from `from` and those around `to`: a frame before, at and after the jump.
        let pairs = [0, 1, 2].map(|ahead: isize| {
            let (old, new) = (from.on(database, ahead), to.on(database, ahead - 1));
            let roots = [old.root(database), new.root(database)];
            let rotations = [old.frame, new.frame].map(|frame| recorded(database, frame));
            (self.age + ahead as f32 - 1.0, roots, rotations)
        });
        let kind = self.kind;
        let offset = |[before, now, after]: [Vec3; 3]| match kind {
            Stitching::Inertialize => InertializedOffset::through(before, now, after),
            _ => InertializedOffset {
                value: now,
                ..InertializedOffset::default()
            },
        };
        self.root =
            offset(pairs.map(|(age, [old, new], _)| {
                old.position + self.root.at(age, FRAMES) - new.position
            }));
        for (joint, decaying) in self.joints.iter_mut().enumerate() {
            *decaying = offset(pairs.map(|(age, roots, rotations)| {
                let [old, new] = match joint {
                    0 => roots.map(|root| root.rotation),
                    _ => rotations.map(|of_frame| of_frame[joint]),
                };
                shortest(turned(decaying, age, old) * new.inverse())
            }));
        }
        self.age = 0.0;
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
            *rotation = turned(offset, age, *rotation);
        }
    }
}

/// A joint's rotation with what is left of its offset.
fn turned(offset: &InertializedOffset, age: f32, rotation: Quat) -> Quat {
    (Quat::from_scaled_axis(offset.at(age, FRAMES)) * rotation).normalize()
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
