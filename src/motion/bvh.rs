//! Biovision Hierarchy files: the exchange format of motion capture.

mod fault;
mod hierarchy;
mod number;
mod read;
mod text;
mod values;
mod write;

pub use hierarchy::MAX_JOINTS;
pub use read::{MAX_BYTES, MAX_ROTATIONS, parse, read};
pub use write::{to_text, write};

use super::clip::Clip;
use super::skeleton::Skeleton;
use glam::{Quat, Vec3};

/// What a BVH file says, in the file's own unit of length and at its own rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Names, parents, offsets and ends as in the file; lengths in FILE units.
    pub skeleton: Skeleton,
    /// Frames a second.
    pub rate: f32,
    /// World position of joint 0, one a frame, file units.
    pub positions: Vec<Vec3>,
    /// Local rotations, `[frame][joint]`.
    pub rotations: Vec<Quat>,
    /// Joints below the root that move against their parents; the skeleton has their mean.
    pub slides: Vec<Slide>,
}

/// The movement of a joint against its parent.
#[derive(Clone, Debug, PartialEq)]
pub struct Slide {
    /// The joint that moves.
    pub joint: usize,
    /// Its offset from its parent, one a frame, file units.
    pub positions: Vec<Vec3>,
}

impl Recording {
    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.positions.len()
    }

    /// Local rotations of one frame, one a joint.
    pub fn pose(&self, frame: usize) -> &[Quat] {
        let joints = self.skeleton.joints();
        &self.rotations[frame * joints..(frame + 1) * joints]
    }

    /// The frames `keep` (which must be inside the recording) as a clip in metres, still at
    /// the recording's own rate and with rigid bones. `unit_m` is metres per file unit.
    pub fn into_clip(self, name: &str, unit_m: f32, keep: std::ops::Range<usize>) -> Clip {
        let joints = self.skeleton.joints();
        let mut skeleton = self.skeleton;
        skeleton.offsets.iter_mut().for_each(|o| *o *= unit_m);
        skeleton.ends.iter_mut().for_each(|(_, o)| *o *= unit_m);
        let rotations = &self.rotations[keep.start * joints..keep.end * joints];
        Clip {
            name: name.to_string(),
            skeleton,
            rate: self.rate,
            positions: self.positions[keep].iter().map(|&p| p * unit_m).collect(),
            rotations: rotations.to_vec(),
            source: String::new(),
            licence: String::new(),
        }
    }
}
