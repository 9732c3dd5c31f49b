//! From the text of a BVH file to a recording.

use super::Recording;
use super::hierarchy::{self, Channel, Hierarchy, problem};
use super::values::{self, Values};
use crate::motion::error::{MotionError, MotionResult};
use glam::{Quat, Vec3};
use std::io::Read;
use std::path::Path;

/// Larger files are refused before they are read.
pub const MAX_BYTES: u64 = 1 << 30;

/// Frames times joints that one file may have (about 0.5 GB of rotations).
pub const MAX_ROTATIONS: usize = 1 << 25;

/// A bone may change its length by this fraction of the longest bone and still count as rigid.
const SLACK: f32 = 0.05;

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
    let file = std::fs::File::open(path).map_err(unreadable)?;
    if file.metadata().map_err(unreadable)?.len() > MAX_BYTES {
        return Err(too_large());
    }
    // A device or a growing file may give more than it said.
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(too_large());
    }
    let valid = match std::str::from_utf8(&bytes) {
        Ok(text) => return parse(text, path),
        Err(error) => error.valid_up_to(),
    };
    let line = 1 + bytes[..valid].iter().filter(|&&b| b == b'\n').count();
    Err(problem(
        path,
        line,
        "bytes that are not UTF-8: a binary file, or joint names in another encoding; a BVH file is plain text",
    ))
}

/// Reads the text of a BVH file; `path` is only for messages.
///
/// Channels are applied in the file's order. A position channel replaces its component of the
/// OFFSET. On joints other than the root, positions that stay put (within 5 % of the longest
/// bone) give the bone as their mean. A root with a single child that does move against it (a
/// "Reference" above the hips) is folded into that child. Any other moving bone is an error.
pub fn parse(text: &str, path: &Path) -> MotionResult<Recording> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let hierarchy = hierarchy::parse(text, path)?;
    let end = hierarchy.end;
    let width = hierarchy.channels.iter().map(Vec::len).sum();
    if width == 0 {
        let no_channels = "no joint has CHANNELS: the file holds a skeleton without motion";
        return Err(problem(path, end, no_channels));
    }
    let values = values::parse(text, path, end, width)?;
    if values.frames.saturating_mul(hierarchy.channels.len()) > MAX_ROTATIONS {
        let too_many = format!(
            "{} frames of {} joints are too many for one file; cut it into shorter recordings",
            values.frames,
            hierarchy.channels.len()
        );
        return Err(problem(path, end, too_many));
    }
    let motion = Motion { hierarchy, values };
    motion
        .into_recording()
        .map_err(|what| problem(path, end, what))
}

/// A file that is well formed; what is left is to see what its numbers mean.
struct Motion {
    hierarchy: Hierarchy,
    values: Values,
}

impl Motion {
    fn into_recording(self) -> Result<Recording, String> {
        let rigid = self.bones();
        let longest = rigid[1..].iter().map(|b| b.0.length()).fold(0.0, f32::max);
        let moving: Vec<usize> = (1..rigid.len())
            .filter(|&joint| rigid[joint].1 > SLACK * longest)
            .collect();
        let slides = if moving.is_empty() {
            None
        } else if moving == [1] && !self.hierarchy.skeleton.parents[2..].contains(&Some(0)) {
            Some(self.positions(1))
        } else {
            let joint = moving[moving.len().min(2) - 1];
            return Err(format!(
                "the joint '{}' moves by {} against its parent; bones must keep their length: export rotations only below the root",
                self.hierarchy.skeleton.names[joint], rigid[joint].1
            ));
        };
        let mut recording = Recording {
            positions: self.positions(0),
            rotations: self.rotations(),
            rate: self.values.rate,
            skeleton: self.hierarchy.skeleton,
        };
        let bones = rigid.into_iter().map(|bone| bone.0);
        recording.skeleton.offsets = bones.collect();
        match slides {
            Some(slides) => Ok(fold_root(recording, &slides)),
            None => Ok(recording),
        }
    }

    /// Each joint's mean offset and the farthest that any frame strays from it.
    fn bones(&self) -> Vec<(Vec3, f32)> {
        let channels = self.hierarchy.channels.iter().enumerate();
        let bone = |(joint, channels): (usize, &Vec<Channel>)| {
            let fixed = self.hierarchy.skeleton.offsets[joint];
            if joint == 0 || !channels.iter().any(|c| matches!(c, Channel::Position(_))) {
                return (fixed, 0.0);
            }
            let positions = self.positions(joint);
            // Summed as differences: a bone that never moves comes out exactly.
            let first = positions[0];
            let drift: Vec3 = positions.iter().map(|&p| p - first).sum();
            let mean = first + drift / positions.len() as f32;
            let strays = positions.iter().map(|p| p.distance(mean));
            (mean, strays.fold(0.0, f32::max))
        };
        channels.map(bone).collect()
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

/// Takes joint 0 away and makes its only child, which moves by `slides` against it, the root.
fn fold_root(recording: Recording, slides: &[Vec3]) -> Recording {
    let mut folded = recording.clone();
    let joints = recording.skeleton.joints();
    folded.rotations.clear();
    for (frame, &slide) in slides.iter().enumerate() {
        let pose = recording.pose(frame);
        folded.positions[frame] += pose[0] * slide;
        folded.rotations.push((pose[0] * pose[1]).normalize());
        folded.rotations.extend(&pose[2..joints]);
    }
    let skeleton = &mut folded.skeleton;
    skeleton.names.remove(0);
    skeleton.offsets.remove(0);
    skeleton.parents.remove(0);
    for parent in &mut skeleton.parents {
        *parent = parent.and_then(|parent| parent.checked_sub(1));
    }
    skeleton.ends.retain(|end| end.0 > 0);
    skeleton.ends.iter_mut().for_each(|end| end.0 -= 1);
    folded
}
