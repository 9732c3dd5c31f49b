//! The performer: synthetic locomotion, the data set that needs no recordings.
//!
//! A random schedule of commands (`plan`) is followed by a point with a heading (`track`).
//! Stride timing (`gait`) and footfalls (`footfall`) are planned on that track, whose future
//! is known; the feet (`feet`) move from one to the next, the pelvis and the upper body
//! (`body`) follow the gait, and the legs (`legs`) join pelvis and feet.
//!
//! The same skeleton also boxes: see [`boxing`].

mod body;
pub mod boxing;
mod ease;
mod feet;
mod figure;
mod footfall;
mod gait;
mod legs;
mod lengths;
mod plan;
mod random;
mod track;

use super::RATE;
use super::clip::Clip;
use super::roles::Roles;
use body::{Bearing, Manner};
pub use boxing::perform_boxing;
use feet::FootState;
use figure::{HIPS, JOINTS};
use glam::{Quat, Vec3};
use lengths::lengths;
use plan::Command;
use random::Random;
use rayon::prelude::*;
use track::Track;

/// Minutes of the default data set: a row count like that of real locomotion sets.
pub const MINUTES: f32 = 39.0;
/// Seconds of the shortest and the longest clip.
const CLIP_SECONDS: (f32, f32) = (25.0, 55.0);
/// Frames planned beyond a clip's end, so that its last footfalls know where they lead.
const AFTERMATH: usize = 60;

/// A clip and what was meant by it.
pub struct Take {
    /// The motion.
    pub clip: Clip,
    /// For each frame, left and right: the toe joint is fixed in the world, from the end of the
    /// landing until the foot leaves.
    pub planted: Vec<[bool; 2]>,
    /// For each frame, the planned velocity over the ground (m/s, y = 0).
    pub velocity: Vec<Vec3>,
}

/// Synthetic locomotion of a total of `minutes`, the same bits for the same `seed`.
pub fn perform(seed: u64, minutes: f32) -> (Vec<Clip>, Roles) {
    let clips = takes(seed, minutes).into_iter().map(|take| take.clip);
    (clips.collect(), figure::roles())
}

/// One clip of a steady, straight walk at so many metres a second.
pub fn perform_walk(seed: u64, seconds: f32, speed: f32) -> (Vec<Clip>, Roles) {
    // What comes before is setting off.
    const BEFORE: usize = 60;
    let frames = (seconds * RATE) as usize + BEFORE;
    let walk = |planned: usize| plan::walk(planned as f32 / RATE, speed);
    let mut clip = take(seed, 0, frames, |_, planned| walk(planned)).clip;
    clip.positions.drain(..BEFORE);
    clip.rotations.drain(..BEFORE * JOINTS);
    clip.name = "synthetic_walk".to_string();
    (vec![clip], figure::roles())
}

/// Synthetic locomotion with the plans behind its clips: see [`perform`].
pub fn takes(seed: u64, minutes: f32) -> Vec<Take> {
    lengths(&mut Random::new(seed, u64::MAX), minutes, CLIP_SECONDS)
        .into_par_iter()
        .enumerate()
        .map(|(index, frames)| {
            take(seed, index, frames, |random, planned| {
                plan::schedule(random, planned as f32 / RATE)
            })
        })
        .collect()
}

/// A take of so many frames; `commands` are drawn for so many frames, too.
fn take(
    seed: u64,
    index: usize,
    frames: usize,
    commands: impl Fn(&mut Random, usize) -> Vec<Command>,
) -> Take {
    let mut random = Random::new(seed, index as u64);
    let manner = Manner::draw(&mut random);
    let planned = frames + AFTERMATH;
    let commands = commands(&mut random, planned);
    let track = Track::follow(&commands, planned);
    let rhythm = gait::Rhythm::of(&track, &mut random);
    let stances = footfall::stances(&track, &rhythm);

    let bearings: Vec<Bearing> = (0..frames)
        .map(|frame| Bearing::at(&track, &manner, rhythm.phase[frame], frame as f32 / RATE))
        .collect();
    let feet: Vec<[FootState; 2]> = (0..frames)
        .map(|frame| {
            let time = frame as f32 / RATE;
            [0, 1].map(|side| feet::foot(&track, &stances[side], &stances[1 - side], side, time))
        })
        .collect();
    let mut pelvis: Vec<(Vec3, Quat)> = bearings
        .iter()
        .map(|bearing| bearing.pelvis(&manner))
        .collect();
    legs::lower(&mut pelvis, &feet);

    let mut rotations = Vec::with_capacity(frames * JOINTS);
    for ((bearing, feet), &pelvis) in bearings.iter().zip(&feet).zip(&pelvis) {
        rotations.extend(pose(bearing, &manner, feet, pelvis));
    }
    Take {
        clip: Clip {
            name: format!("synthetic_{index:03}"),
            skeleton: figure::skeleton(),
            rate: RATE,
            positions: pelvis.iter().map(|&(position, _)| position).collect(),
            rotations,
            source: format!("synthetic: footwork's performer, seed {seed}"),
            licence: "CC0-1.0".to_string(),
        },
        planted: feet
            .iter()
            .map(|pair| pair.map(|foot| foot.planted))
            .collect(),
        velocity: track.0[..frames]
            .iter()
            .map(|moment| moment.velocity)
            .collect(),
    }
}

/// The local rotations of all joints at one frame.
fn pose(
    bearing: &Bearing,
    manner: &Manner,
    feet: &[FootState; 2],
    (position, rotation): (Vec3, Quat),
) -> [Quat; JOINTS] {
    let mut pose = [Quat::IDENTITY; JOINTS];
    pose[HIPS] = rotation;
    bearing.upper(manner, &mut pose);
    legs::join(position, feet, &mut pose);
    pose
}
