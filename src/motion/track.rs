//! Where the hips and the ends of the limbs are, frame by frame.

use super::bvh::Recording;
use super::limbs::Limbs;
use super::roles::Roles;
use super::skeleton::Skeleton;
use super::units;
use glam::{Quat, Vec3};

/// Points of a recording in lengths of its legs, so that no unit is needed.
pub struct LimbTrack {
    /// The hips, one a frame.
    pub hips: Vec<Vec3>,
    /// Feet, then hands or, without arms, shoulders: from the hips, one a frame.
    pub ends: Vec<[Vec3; 4]>,
    /// The lower of ankles and toes, one a frame.
    pub lowest: Vec<f32>,
    /// Frames a second.
    pub rate: f32,
}

impl LimbTrack {
    /// Follows a recording whose root is the hips, and y up.
    pub fn of(recording: &Recording, roles: &Roles) -> LimbTrack {
        let skeleton = &recording.skeleton;
        let scale = 1.0 / units::leg(skeleton, roles).max(f32::MIN_POSITIVE);
        let hands = Limbs::of(skeleton, roles)
            .map_or([roles.left_shoulder, roles.right_shoulder], |limbs| {
                limbs.arms.map(|arm| arm[2])
            });
        let ends = [roles.left_foot, roles.right_foot, hands[0], hands[1]];
        let low = [
            roles.left_foot,
            roles.right_foot,
            roles.left_toe,
            roles.right_toe,
        ];
        let frames = recording.frames();
        let mut track = LimbTrack {
            hips: recording.positions.iter().map(|&p| p * scale).collect(),
            ends: Vec::with_capacity(frames),
            lowest: Vec::with_capacity(frames),
            rate: recording.rate,
        };
        let mut at = Chains::new(skeleton, ends.into_iter().chain(low));
        for frame in 0..frames {
            let points = at.points(recording.pose(frame));
            track.ends.push(ends.map(|joint| points[joint] * scale));
            let lowest = low.map(|joint| points[joint].y * scale);
            let lowest = lowest.into_iter().fold(f32::INFINITY, f32::min);
            track.lowest.push(track.hips[frame].y + lowest);
        }
        track
    }

    /// Keeps only these frames.
    pub fn keep(&mut self, frames: std::ops::Range<usize>) {
        self.hips = self.hips[frames.clone()].to_vec();
        self.ends = self.ends[frames.clone()].to_vec();
        self.lowest = self.lowest[frames].to_vec();
    }
}

/// Forward kinematics of some joints, from the root.
struct Chains<'a> {
    skeleton: &'a Skeleton,
    /// The joints and all that carry them, ascending.
    joints: Vec<usize>,
    at: Vec<Vec3>,
    turned: Vec<Quat>,
}

impl<'a> Chains<'a> {
    fn new(skeleton: &'a Skeleton, joints: impl Iterator<Item = usize>) -> Chains<'a> {
        let mut inside = vec![false; skeleton.joints()];
        for joint in joints {
            let up = std::iter::successors(Some(joint), |&joint| skeleton.parents[joint]);
            up.for_each(|joint| inside[joint] = true);
        }
        Chains {
            joints: (1..inside.len()).filter(|&joint| inside[joint]).collect(),
            at: vec![Vec3::ZERO; inside.len()],
            turned: vec![Quat::IDENTITY; inside.len()],
            skeleton,
        }
    }

    /// Positions from the root in one pose; of other joints than those asked for they mean nothing.
    fn points(&mut self, pose: &[Quat]) -> &[Vec3] {
        self.turned[0] = pose[0];
        for &joint in &self.joints {
            let parent = self.skeleton.parents[joint].unwrap_or_default();
            let turned = self.turned[parent];
            self.at[joint] = self.at[parent] + turned * self.skeleton.offsets[joint];
            self.turned[joint] = turned * pose[joint];
        }
        &self.at
    }
}
