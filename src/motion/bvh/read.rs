//! From the text of a BVH file to a recording.

use super::fault::problem;
use super::hierarchy::{self, Channel, Hierarchy};
use super::text::{clean, decode};
use super::values::{self, Values};
use super::{Recording, Slide};
use crate::input_file;
use crate::motion::error::{MotionError, MotionResult};
use glam::{Quat, Vec3};
use std::io::Read;
use std::path::Path;

/// Larger files are refused before they are read.
pub const MAX_BYTES: u64 = 1 << 30;

/// Frames times joints that one file may have (about 0.5 GB of rotations).
pub const MAX_ROTATIONS: usize = 1 << 25;

/// Reads a BVH file. Lengths stay in the file's unit, the rate is the file's own.
///
/// Errors: an unreadable, too large, binary, truncated or malformed file, with the line.
pub fn read(path: &Path) -> MotionResult<Recording> {
    let unreadable = |error| MotionError::Read {
        path: path.to_path_buf(),
        error,
    };
    let too_large = || MotionError::TooLarge {
        path: path.to_path_buf(),
        limit: MAX_BYTES,
    };
    if path.metadata().map_err(unreadable)?.len() > MAX_BYTES {
        return Err(too_large());
    }
    let file = input_file::open(path, MAX_BYTES).map_err(unreadable)?;
    // A growing file may give more than it said.
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(too_large());
    }
    parse(&decode(&bytes, path)?, path)
}

/// Reads the text of a BVH file; `path` is only for messages.
///
/// Channels are applied in the file's order. A position channel replaces its component of the
/// OFFSET; on joints other than the root the mean of all frames is the bone. Where those of all
/// joints below the root are zero throughout, while OFFSETs are not, the OFFSETs hold.
pub fn parse(text: &str, path: &Path) -> MotionResult<Recording> {
    let text = &*clean(text);
    let hierarchy = hierarchy::parse(text, path)?;
    let end = hierarchy.end;
    let width = hierarchy.channels.iter().map(Vec::len).sum();
    if width == 0 {
        let no_channels = "no joint has CHANNELS: the file holds a skeleton without motion";
        return Err(problem(path, end, no_channels));
    }
    let values = values::parse(&text[hierarchy.length..], path, end, width)?;
    if values.frames.saturating_mul(hierarchy.channels.len()) > MAX_ROTATIONS {
        let too_many = format!(
            "{} frames of {} joints are too many for one file; cut it into shorter recordings",
            values.frames,
            hierarchy.channels.len()
        );
        return Err(problem(path, end, too_many));
    }
    let motion = Motion {
        offsets_hold: offsets_hold(&hierarchy, &values, width),
        hierarchy,
        values,
    };
    Ok(motion.into_recording())
}

/// Whether no position channel below the root ever says anything, while OFFSETs do.
fn offsets_hold(hierarchy: &Hierarchy, values: &Values, width: usize) -> bool {
    let channels = hierarchy.channels.iter().enumerate();
    let channels = channels.flat_map(|(joint, channels)| channels.iter().map(move |c| (joint, c)));
    let below = channels
        .enumerate()
        .filter(|(_, (joint, channel))| *joint > 0 && matches!(channel, Channel::Position(_)));
    let (columns, joints): (Vec<usize>, Vec<usize>) =
        below.map(|(column, (joint, _))| (column, joint)).unzip();
    let offsets = &hierarchy.skeleton.offsets;
    joints.iter().any(|&joint| offsets[joint] != Vec3::ZERO)
        && values
            .numbers
            .chunks_exact(width)
            .all(|frame| columns.iter().all(|&column| frame[column] == 0.0))
}

/// A file that is well formed; what is left is to see what its numbers mean.
struct Motion {
    hierarchy: Hierarchy,
    values: Values,
    /// Whether position channels below the root mean nothing.
    offsets_hold: bool,
}

impl Motion {
    fn into_recording(self) -> Recording {
        let (bones, slides) = self.bones();
        let mut recording = Recording {
            positions: self.positions(0),
            rotations: self.rotations(),
            slides,
            rate: self.values.rate,
            skeleton: self.hierarchy.skeleton,
        };
        recording.skeleton.offsets = bones;
        recording
    }

    /// Each joint's mean offset, and the joints whose offset is not the same in all frames.
    fn bones(&self) -> (Vec<Vec3>, Vec<Slide>) {
        let (mut bones, mut slides) = (self.hierarchy.skeleton.offsets.clone(), Vec::new());
        for (joint, channels) in self.hierarchy.channels.iter().enumerate().skip(1) {
            if self.offsets_hold || !channels.iter().any(|c| matches!(c, Channel::Position(_))) {
                continue;
            }
            let positions = self.positions(joint);
            // Summed as differences: a bone that never moves comes out exactly.
            let first = positions[0];
            let drift: Vec3 = positions.iter().map(|&p| p - first).sum();
            bones[joint] = first + drift / positions.len() as f32;
            if positions.iter().any(|&p| p != first) {
                slides.push(Slide { joint, positions });
            }
        }
        (bones, slides)
    }

    /// A joint's offset from its parent, frame by frame; for the root, its position.
    fn positions(&self, joint: usize) -> Vec<Vec3> {
        let channels = &self.hierarchy.channels;
        let start: usize = channels[..joint].iter().map(Vec::len).sum();
        let width: usize = channels.iter().map(Vec::len).sum();
        let position = |frame: &[f32]| {
            let mut position = self.hierarchy.skeleton.offsets[joint];
            for (channel, &value) in channels[joint].iter().zip(&frame[start..]) {
                if let &Channel::Position(axis) = channel {
                    position[axis] = value;
                }
            }
            position
        };
        self.values
            .numbers
            .chunks_exact(width)
            .map(position)
            .collect()
    }

    fn rotations(&self) -> Vec<Quat> {
        let channels = &self.hierarchy.channels;
        let mut rotations = Vec::with_capacity(self.values.frames * channels.len());
        let mut numbers = self.values.numbers.iter();
        for _ in 0..self.values.frames {
            for channels in channels {
                // The zip takes the channels first, so no number is lost at the end of a joint.
                let turns = channels.iter().zip(numbers.by_ref());
                let rotation = turns.fold(Quat::IDENTITY, |rotation, (channel, &value)| {
                    rotation * turn(*channel, value)
                });
                rotations.push(rotation.normalize());
            }
        }
        rotations
    }
}

fn turn(channel: Channel, degrees: f32) -> Quat {
    let angle = degrees.to_radians();
    match channel {
        Channel::Rotation(0) => Quat::from_rotation_x(angle),
        Channel::Rotation(1) => Quat::from_rotation_y(angle),
        Channel::Rotation(_) => Quat::from_rotation_z(angle),
        Channel::Position(_) => Quat::IDENTITY,
    }
}
