//! One frame of a recording.

use glam::{Quat, Vec3};

/// A recorded frame: positions (m) and rotations of the skeleton's joints, z up.
pub struct RecordedFrame {
    pub at: Vec<Vec3>,
    pub rotation: Vec<Quat>,
}
