//! Which way is up in a recording: BVH files do not say.
//!
//! Y is up in most files, z in those of programs like Blender. In a standing person the shoulders
//! are above the feet, so the axis along which they are in nearly all frames is up. A person who lies
//! still looks the same, but for two things: where the rest pose stands, and whether the hips travel
//! across that axis and not along it.

use super::bvh::Recording;
use super::roles::Roles;
use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

/// An axis of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum UpAxis {
    /// Most files.
    #[serde(rename = "y")]
    Y,
    /// Blender and other programs for which the ground is x and y.
    #[serde(rename = "z")]
    Z,
    /// As from joints that lie along x.
    #[serde(rename = "x")]
    X,
    /// As from images, whose rows go down.
    #[serde(rename = "-y")]
    MinusY,
    /// Down along z.
    #[serde(rename = "-z")]
    MinusZ,
    /// Down along x.
    #[serde(rename = "-x")]
    MinusX,
}

impl UpAxis {
    /// All of them, the commonest first.
    pub const ALL: [UpAxis; 6] = [
        UpAxis::Y,
        UpAxis::Z,
        UpAxis::X,
        UpAxis::MinusY,
        UpAxis::MinusZ,
        UpAxis::MinusX,
    ];

    /// `y`, `-z` and so on.
    pub fn name(self) -> &'static str {
        match self {
            UpAxis::Y => "y",
            UpAxis::Z => "z",
            UpAxis::X => "x",
            UpAxis::MinusY => "-y",
            UpAxis::MinusZ => "-z",
            UpAxis::MinusX => "-x",
        }
    }

    /// The unit vector that points up.
    pub fn direction(self) -> Vec3 {
        match self {
            UpAxis::Y => Vec3::Y,
            UpAxis::Z => Vec3::Z,
            UpAxis::X => Vec3::X,
            UpAxis::MinusY => Vec3::NEG_Y,
            UpAxis::MinusZ => Vec3::NEG_Z,
            UpAxis::MinusX => Vec3::NEG_X,
        }
    }

    /// The rotation that takes this axis to y.
    fn to_y(self) -> Quat {
        let half = std::f32::consts::FRAC_PI_2;
        match self {
            UpAxis::Y => Quat::IDENTITY,
            UpAxis::Z => Quat::from_rotation_x(-half),
            UpAxis::X => Quat::from_rotation_z(half),
            UpAxis::MinusY => Quat::from_rotation_x(2.0 * half),
            UpAxis::MinusZ => Quat::from_rotation_x(half),
            UpAxis::MinusX => Quat::from_rotation_z(-half),
        }
    }
}

/// Frames that are looked at, spread over the recording.
const SAMPLES: usize = 64;

/// A person stands up along an axis if shoulders and feet lie along it within about 37 degrees.
const ALONG: f32 = 0.8;

/// Who stands along y in this fraction of the frames does, whatever happens in the others.
const ENOUGH: f32 = 0.3;

/// To take another axis for up, this fraction must stand along it.
const NEARLY_ALL: f32 = 0.8;

/// What is seen of the way up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UpEvidence {
    /// A person stands along this axis.
    Stands(UpAxis),
    /// A person stands along this axis, or lies along it: in this fraction of the frames.
    StandsOrLies(UpAxis, f32),
    /// No axis, as while crawling.
    Unclear,
}

/// Which way the person of a recording stands. Its root must be the hips.
pub fn find(recording: &Recording, roles: &Roles) -> UpEvidence {
    let frames = recording.frames();
    let step = frames.div_ceil(SAMPLES).max(1);
    let trunks: Vec<Vec3> = (0..frames)
        .step_by(step)
        .map(|frame| trunk(recording, roles, recording.pose(frame)))
        .collect();
    let share = |axis: UpAxis| {
        let along = trunks
            .iter()
            .filter(|trunk| trunk.dot(axis.direction()) > ALONG);
        along.count() as f32 / trunks.len().max(1) as f32
    };
    if share(UpAxis::Y) >= ENOUGH {
        return UpEvidence::Stands(UpAxis::Y);
    }
    match UpAxis::ALL
        .into_iter()
        .find(|&axis| share(axis) >= NEARLY_ALL)
    {
        None => UpEvidence::Unclear,
        Some(axis) => {
            match rests_along(recording, roles, axis) || travels_across(recording, axis) {
                true => UpEvidence::Stands(axis),
                false => UpEvidence::StandsOrLies(axis, share(axis)),
            }
        }
    }
}

/// From the feet to the shoulders, unit.
fn trunk(recording: &Recording, roles: &Roles, pose: &[Quat]) -> Vec3 {
    let (at, _) = recording.skeleton.world(Vec3::ZERO, pose);
    let shoulders = at[roles.left_shoulder] + at[roles.right_shoulder];
    let feet = at[roles.left_foot] + at[roles.right_foot];
    (shoulders - feet).normalize_or_zero()
}

fn rests_along(recording: &Recording, roles: &Roles, axis: UpAxis) -> bool {
    let rest = vec![Quat::IDENTITY; recording.skeleton.joints()];
    trunk(recording, roles, &rest).dot(axis.direction()) > ALONG
}

/// Whether the hips travel farther than a person is tall, and not up and down.
fn travels_across(recording: &Recording, axis: UpAxis) -> bool {
    let low = recording
        .positions
        .iter()
        .copied()
        .fold(Vec3::INFINITY, Vec3::min);
    let high = recording
        .positions
        .iter()
        .copied()
        .fold(Vec3::NEG_INFINITY, Vec3::max);
    let extent = high - low;
    let along = extent.dot(axis.direction().abs());
    let across = (extent * (Vec3::ONE - axis.direction().abs())).length();
    let bones = recording.skeleton.offsets[1..].iter();
    let body = bones.map(|offset| offset.length()).fold(0.0, f32::max);
    across > 4.0 * body && along < 0.25 * across
}

/// Turns a recording so that y is up.
pub fn turn(recording: &mut Recording, axis: UpAxis) {
    if axis == UpAxis::Y {
        return;
    }
    let turn = axis.to_y();
    let joints = recording.skeleton.joints();
    recording.positions.iter_mut().for_each(|p| *p = turn * *p);
    for pose in recording.rotations.chunks_exact_mut(joints) {
        pose[0] = (turn * pose[0]).normalize();
    }
    recording.skeleton.offsets[0] = turn * recording.skeleton.offsets[0];
}
