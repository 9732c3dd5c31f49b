//! How lists are loaded.

use crate::motion::import::ImportOptions;

/// Choices of how a list is loaded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotionListOptions {
    /// How BVH files are read, and whether clips are mirrored for which the list does not say.
    pub import: ImportOptions,
    /// Whether feet that stand over 10 cm off the ground are brought to it; else such a clip is refused.
    pub ground: bool,
    /// Frames at 30 Hz that each clip needs; at least two.
    pub min_frames: usize,
}

impl MotionListOptions {
    /// Frames that each clip needs to have velocities, and for what its user wants.
    pub(super) fn needed(&self) -> usize {
        self.min_frames.max(2)
    }
}
