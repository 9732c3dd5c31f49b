//! DeepMimic's recordings, which are of a body with the humanoid's own bones.
//!
//! A file is JSON: `{"Loop": ..., "Frames": [[...], ...]}`. A frame has 44 numbers: its duration (s), the
//! root's position (m) and rotation, then a joint after the other, a quaternion (w first) or the angle
//! of an elbow or knee (rad). The character has x forward, y up and z to its right.

use super::drive::rotation_vector;
use super::kinematics::{quaternion, store};
use super::model::{Joint, JointKind, Model};
use super::motion_clip::{MotionClip, between};
use super::retarget::{self, RetargetError, joint};
use crate::input_file;
use crate::motion::RATE;
use glam::{Quat, Vec3};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Numbers of a frame.
const NUMBERS: usize = 44;

/// Frames last no longer, s.
const LONGEST: f64 = 10.0;

/// Quaternions are at least so long: public clips have some of 0.58.
const SHORTEST: f32 = 0.1;

/// The humanoid's bodies in the order of a frame's joints, after the root.
const JOINTS: [(&str, JointKind); 12] = [
    ("torso", JointKind::Ball),
    ("head", JointKind::Ball),
    ("right_thigh", JointKind::Ball),
    ("right_shin", JointKind::Hinge),
    ("right_foot", JointKind::Ball),
    ("right_upper_arm", JointKind::Ball),
    ("right_lower_arm", JointKind::Hinge),
    ("left_thigh", JointKind::Ball),
    ("left_shin", JointKind::Hinge),
    ("left_foot", JointKind::Ball),
    ("left_upper_arm", JointKind::Ball),
    ("left_lower_arm", JointKind::Hinge),
];

/// Why a file makes no motion.
#[derive(Debug, thiserror::Error)]
pub enum DeepMimicError {
    /// A file that cannot be read.
    #[error("cannot read {}: {error}; check that it exists and may be read", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why it cannot be read.
        error: std::io::Error,
    },
    /// A file that is not JSON of DeepMimic's form, or is cut off.
    #[error("{} is no whole DeepMimic recording, {{\"Loop\": ..., \"Frames\": [[...], ...]}}: {error}", .path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// What is wrong, and in which line.
        error: serde_json::Error,
    },
    /// A damaged frame.
    #[error("{}, frame {frame}: {problem}; correct the frame or cut the file before it", .path.display())]
    Frame {
        /// The file.
        path: PathBuf,
        /// Number of the frame, from 1.
        frame: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// A recording that has no two frames at 30 Hz.
    #[error("{} has {frames} frames, {seconds} s: a motion needs at least two frames and 1/30 s", .path.display())]
    Short {
        /// The file.
        path: PathBuf,
        /// Frames in the file.
        frames: usize,
        /// From the first to the last, s.
        seconds: f32,
    },
    /// A model without the humanoid's parts.
    #[error(transparent)]
    Model(#[from] RetargetError),
}

#[derive(Deserialize)]
#[serde(rename_all = "PascalCase")]
struct File {
    frames: Vec<Vec<f64>>,
}

/// The motion of a file in the humanoid `model`, at 30 Hz: it begins above the origin and stands on the
/// ground, and joints stay within their ranges. A recording that loops is played once.
///
/// # Errors
/// See [`DeepMimicError`].
pub fn read(path: &Path, model: &Model) -> Result<MotionClip, DeepMimicError> {
    let keyframes = keyframes(path, model)?;
    let mut q: Vec<f32> = resampled(&keyframes, model)
        .into_iter()
        .flat_map(|q| within_ranges(model, q))
        .collect();
    if q.len() < 2 * model.nq() {
        return Err(DeepMimicError::Short {
            path: path.to_path_buf(),
            frames: keyframes.len(),
            seconds: keyframes.last().map_or(0.0, |last| last.time as f32),
        });
    }
    let footing = retarget::footing(model)?;
    footing.stand(&mut q);
    footing.begin_at_origin(&mut q);
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Ok(MotionClip::new(&name, model, RATE, q))
}

/// The humanoid's positions at a time, s.
struct Keyframe {
    time: f64,
    q: Vec<f32>,
}

/// Bytes of the largest recording: hours of motion.
const MAX_BYTES: u64 = 1 << 28;

fn keyframes(path: &Path, model: &Model) -> Result<Vec<Keyframe>, DeepMimicError> {
    let text = input_file::text(path, MAX_BYTES).map_err(|error| DeepMimicError::Read {
        path: path.to_path_buf(),
        error,
    })?;
    let file: File = serde_json::from_str(&text).map_err(|error| DeepMimicError::Json {
        path: path.to_path_buf(),
        error,
    })?;
    let joints = joints(model)?;
    let last = file.frames.len().saturating_sub(1);
    let (mut time, mut keyframes) = (0.0, Vec::with_capacity(file.frames.len()));
    for (index, frame) in file.frames.iter().enumerate() {
        let q = check(frame, index == last).and_then(|()| positions(frame, model, &joints));
        let q = q.map_err(|problem| DeepMimicError::Frame {
            path: path.to_path_buf(),
            frame: index + 1,
            problem,
        })?;
        keyframes.push(Keyframe { time, q });
        time += frame[0];
    }
    Ok(keyframes)
}

/// The humanoid's joints in the order of a frame's.
fn joints(model: &Model) -> Result<Vec<&Joint>, RetargetError> {
    let root = std::iter::once(("pelvis", JointKind::Free));
    let joints = root.chain(JOINTS);
    joints
        .map(|(body, kind)| joint(model, body, kind))
        .collect()
}

/// Refuses frames of another form; nothing reads the last one's duration.
fn check(frame: &[f64], last: bool) -> Result<(), String> {
    if frame.len() != NUMBERS {
        return Err(format!("it has {} numbers, not {NUMBERS}", frame.len()));
    }
    let possible = |&number: &f64| (number as f32).is_finite();
    if let Some(wrong) = frame.iter().position(|number| !possible(number)) {
        return Err(format!("its number {} is {}", wrong + 1, frame[wrong]));
    }
    let duration = frame[0];
    match last || (duration > 0.0 && duration <= LONGEST) {
        true => Ok(()),
        false => Err(format!(
            "it lasts {duration} s, where more than 0 and at most {LONGEST} are possible"
        )),
    }
}

/// The humanoid's positions in a checked frame.
fn positions(frame: &[f64], model: &Model, joints: &[&Joint]) -> Result<Vec<f32>, String> {
    let mut q = model.qpos0.clone();
    let mut numbers = frame[1..].iter().map(|&number| number as f32);
    let mut next = || numbers.next().unwrap_or_default();
    for joint in joints {
        let at = match joint.kind {
            // Its hinges turn about z, which is -y here.
            JointKind::Hinge => {
                q[joint.q] = -next();
                continue;
            }
            JointKind::Ball => joint.q,
            JointKind::Free => {
                let position = upright(Vec3::new(next(), next(), next()));
                q[joint.q..][..3].copy_from_slice(&position.to_array());
                joint.q + 3
            }
        };
        let w = next();
        let rotation = upright(Vec3::new(next(), next(), next())).extend(w);
        let length = rotation.length();
        if !(SHORTEST..f32::INFINITY).contains(&length) {
            let body = &model.bodies[joint.body].name;
            return Err(format!("the rotation of its {body} is no quaternion"));
        }
        store(&mut q[at..], Quat::from_vec4(rotation / length));
    }
    Ok(q)
}

/// Turns DeepMimic's axes, y up and z to the right, to the bodies': z up and y to the left.
fn upright(v: Vec3) -> Vec3 {
    Vec3::new(v.x, -v.z, v.y)
}

/// Positions at 30 Hz, from the first frame on and no further than the last; none of fewer than two.
fn resampled(keyframes: &[Keyframe], model: &Model) -> Vec<Vec<f32>> {
    let [_, .., last] = keyframes else {
        return Vec::new();
    };
    let rate = f64::from(RATE);
    // Durations are rounded.
    let count = (last.time * rate + 1e-2) as usize + 1;
    let frames = (0..count).map(|frame| {
        let time = (frame as f64 / rate).min(last.time);
        let to = keyframes.partition_point(|keyframe| keyframe.time < time);
        let [from, to] = [&keyframes[to.max(1) - 1], &keyframes[to.max(1)]];
        let share = (time - from.time) / (to.time - from.time);
        between(model, &from.q, &to.q, share as f32)
    });
    frames.collect()
}

/// Positions with every joint brought back into its range.
fn within_ranges(model: &Model, mut q: Vec<f32>) -> Vec<f32> {
    for joint in &model.joints {
        let Some([least, most]) = joint.range else {
            continue;
        };
        match joint.kind {
            JointKind::Hinge => q[joint.q] = q[joint.q].clamp(least, most),
            _ => {
                let rotation = rotation_vector(quaternion(&q[joint.q..]));
                let rotation = rotation.clamp_length_max(most);
                store(&mut q[joint.q..], Quat::from_scaled_axis(rotation));
            }
        }
    }
    q
}
