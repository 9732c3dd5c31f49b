//! One recording.

use super::skeleton::Skeleton;
use glam::{Quat, Vec3};

/// A recording at a fixed rate: root positions and local joint rotations.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// Name, that of its file.
    pub name: String,
    /// Each clip brings its own bone lengths: subjects of one capture differ.
    pub skeleton: Skeleton,
    /// Frames a second.
    pub rate: f32,
    /// World position of joint 0, one a frame, metres, y up.
    pub positions: Vec<Vec3>,
    /// Local rotations, `[frame][joint]`.
    pub rotations: Vec<Quat>,
    /// Where it comes from and under which terms; empty if unknown.
    pub source: String,
    /// Terms of use; empty if unknown.
    pub licence: String,
}

impl Clip {
    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.positions.len()
    }

    /// Length, s.
    pub fn seconds(&self) -> f32 {
        self.frames() as f32 / self.rate
    }

    /// Local rotations of one frame, one a joint.
    pub fn pose(&self, frame: usize) -> &[Quat] {
        let joints = self.skeleton.joints();
        &self.rotations[frame * joints..(frame + 1) * joints]
    }

    /// World positions (m) and rotations of every joint at one frame.
    pub fn world(&self, frame: usize) -> (Vec<Vec3>, Vec<Quat>) {
        self.skeleton.world(self.positions[frame], self.pose(frame))
    }
}
