//! How a foot is held, whatever its bones say of the sole below them.

use super::anatomy::Foot;
use super::recorded_frame::RecordedFrame;
use glam::{Mat3, Quat, Vec3};

/// A foot whose sole has been found.
#[derive(Clone, Copy, Debug)]
pub struct Sole {
    foot: Foot,
    /// Takes toe and up of a standing foot, x and z, to its frame.
    axes: Quat,
}

/// An ankle is lowest when its foot stands flat: in this share of the frames, or more.
const STANDING: usize = 10;

impl Sole {
    /// What points up in the foot's frame while the ankle is lowest is across the sole.
    pub fn of(foot: Foot, frames: &[RecordedFrame]) -> Sole {
        let height = |frame: &&RecordedFrame| frame.at[foot.ankle].z;
        let mut low: Vec<&RecordedFrame> = frames.iter().collect();
        low.sort_by(|a, b| height(a).total_cmp(&height(b)));
        low.truncate(frames.len().div_ceil(STANDING));
        let up: Vec3 = low
            .iter()
            .map(|frame| frame.rotation[foot.ankle].inverse() * Vec3::Z)
            .sum();
        let up = up
            .try_normalize()
            .unwrap_or(foot.toe.any_orthonormal_vector());
        let toe = foot.toe.reject_from(up).try_normalize();
        let toe = toe.unwrap_or(up.any_orthonormal_vector());
        Sole {
            foot,
            axes: Quat::from_mat3(&Mat3::from_cols(toe, up.cross(toe), up)),
        }
    }

    /// Takes a standing foot to where it is, its toe along x.
    pub fn rotation(&self, frame: &RecordedFrame) -> Quat {
        frame.rotation[self.foot.ankle] * self.axes
    }
}
