//! The performer boxes: guard, steps, pivots and punches, the data set of the boxing tasks.
//!
//! A random schedule (`plan`) writes a choreography (`choreography`): curves of what hips, shoulders
//! and feet do (`curve`, `footing`) and a list of punches (`punch`). The trunk follows its
//! curves (`trunk`), the fists fly from the guard and back (`fists`), arms and legs join what they
//! must reach (`arms`, `stand`), and the whole moves over its feet so that it keeps its balance
//! (`balance`).

mod arms;
mod balance;
mod choreography;
mod curve;
mod fists;
mod footing;
mod habits;
mod plan;
mod punch;
mod stand;
mod trunk;

pub use choreography::BoxingStep;
pub use punch::{PunchKind, PunchTarget, ThrownPunch};

use super::figure::{self, HIPS, JOINTS};
use super::lengths::lengths;
use super::random::Random;
use crate::motion::RATE;
use crate::motion::clip::Clip;
use crate::motion::roles::Roles;
use crate::motion::skeleton::Skeleton;
use choreography::Choreography;
use fists::Flight;
use glam::Quat;
use habits::Habits;
use rayon::prelude::*;
use trunk::Trunk;

/// Minutes of a data set of boxing.
pub const MINUTES: f32 = 5.0;
/// Seconds of the shortest and the longest clip.
const CLIP_SECONDS: (f32, f32) = (20.0, 30.0);
/// Streams of random numbers from this one on are none of the locomotion's.
const STREAM: u64 = 1 << 32;

/// A clip of boxing and what was meant by it.
pub struct BoxingTake {
    /// The motion.
    pub clip: Clip,
    /// For each frame, left and right: the foot stands, its toe joint fixed in the world.
    pub planted: Vec<[bool; 2]>,
    /// In order of time; the last ones may go on beyond the clip.
    pub punches: Vec<ThrownPunch>,
    /// In order of time; the last one may go on beyond the clip.
    pub steps: Vec<BoxingStep>,
}

/// Synthetic boxing of a total of `minutes`, the same bits for the same `seed`, by the skeleton of
/// [`perform`](super::perform).
pub fn perform_boxing(seed: u64, minutes: f32) -> (Vec<Clip>, Roles) {
    let takes = boxing_takes(seed, minutes).into_iter();
    (takes.map(|take| take.clip).collect(), figure::roles())
}

/// Synthetic boxing with the plans behind its clips: see [`perform_boxing`].
pub fn boxing_takes(seed: u64, minutes: f32) -> Vec<BoxingTake> {
    lengths(&mut Random::new(seed, STREAM - 1), minutes, CLIP_SECONDS)
        .into_par_iter()
        .enumerate()
        .map(|(index, frames)| take(seed, index, frames))
        .collect()
}

fn take(seed: u64, index: usize, frames: usize) -> BoxingTake {
    let mut random = Random::new(seed, STREAM + index as u64);
    let habits = Habits::draw(&mut random);
    let planned = (frames + balance::AFTERMATH) as f32 / RATE;
    let plan = plan::choreograph(&mut random, planned);
    let skeleton = figure::skeleton();

    let poses = upper_bodies(&plan, &habits, &skeleton, frames);
    let centres = balance::track(&plan, &habits, frames);
    let (positions, poses) = stand::stand(&plan, &habits, &skeleton, poses, &centres);

    let times = (0..frames).map(|frame| frame as f32 / RATE);
    BoxingTake {
        planted: times
            .map(|time| [0, 1].map(|side| plan.feet[side].is_planted(time)))
            .collect(),
        clip: Clip {
            name: format!("boxing_{index:03}"),
            skeleton,
            rate: RATE,
            positions,
            rotations: poses.concat(),
            source: format!("synthetic: footwork's performer boxing, seed {seed}"),
            licence: "CC0-1.0".to_string(),
        },
        punches: plan.punches,
        steps: plan.steps,
    }
}

/// All but the legs, and the hips turned to where the boxer faces, at each frame.
fn upper_bodies(
    plan: &Choreography,
    habits: &Habits,
    skeleton: &Skeleton,
    frames: usize,
) -> Vec<[Quat; JOINTS]> {
    let posed = |time: f32| {
        let mut pose = [Quat::IDENTITY; JOINTS];
        let stretch = fists::stretch(plan, time);
        let trunk = Trunk::pose(plan, habits, time, stretch, skeleton, &mut pose);
        (pose, trunk)
    };
    let aimed = plan.punches.iter().map(|&punch| {
        let (_, trunk) = posed(punch.apex());
        Flight::aimed(punch, &trunk, stand::height(plan, habits, punch.apex()))
    });
    let flights: Vec<Flight> = aimed.collect();
    (0..frames)
        .map(|frame| {
            let time = frame as f32 / RATE;
            let (mut pose, trunk) = posed(time);
            for side in 0..2 {
                let fist = fists::fist(side, &flights, habits, time, &trunk);
                arms::reach(&trunk, side, &fist, &mut pose);
            }
            pose[HIPS] = Quat::from_rotation_y(plan.heading.at(time)) * pose[HIPS];
            pose
        })
        .collect()
}
