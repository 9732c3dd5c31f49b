//! Foot contacts of the recordings, from the speed and height of heel and toe.

use super::leg::{LegJoints, world};
use crate::motion::RATE;
use crate::motion::database::Database;
use glam::{Quat, Vec3};
use rayon::prelude::*;

/// A point of the sole that moves slower than this stands, m/s.
const SPEED: f32 = 0.25;
/// A point this far above where it stands does not, m.
const HEIGHT: f32 = 0.06;
/// Frames on either side that have a say: flickers of a frame or two go under.
const AROUND: usize = 2;

/// The part of a foot that bears weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FootContact {
    /// Not on the ground.
    Air,
    /// The heel alone.
    Heel,
    /// The ball, with or without the heel.
    Toe,
}

/// Heel and toe, the points of the sole, in the world, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolePoints {
    /// The heel.
    pub heel: Vec3,
    /// The toe joint.
    pub toe: Vec3,
}

impl SolePoints {
    /// The sole of a leg in a pose.
    pub fn of(leg: &LegJoints, positions: &[Vec3], rotations: &[Quat]) -> SolePoints {
        SolePoints {
            heel: positions[leg.foot] + rotations[leg.foot] * leg.heel,
            toe: positions[leg.toe],
        }
    }

    /// The point that bears the weight.
    pub fn point(&self, contact: FootContact) -> Option<Vec3> {
        match contact {
            FootContact::Air => None,
            FootContact::Heel => Some(self.heel),
            FootContact::Toe => Some(self.toe),
        }
    }
}

/// The contacts of both feet in every frame of the database, left first.
pub fn contacts(database: &Database, legs: &[LegJoints; 2]) -> Vec<[FootContact; 2]> {
    let soles: Vec<[SolePoints; 2]> = (0..database.frames())
        .into_par_iter()
        .map(|frame| {
            let (positions, rotations) = world(database, frame);
            [0, 1].map(|side| SolePoints::of(&legs[side], &positions, &rotations))
        })
        .collect();
    let mut contacts = vec![[FootContact::Air; 2]; soles.len()];
    for clip in &database.clips {
        let frames = clip.first..clip.first + clip.frames;
        for side in [0, 1] {
            let soles: Vec<SolePoints> = soles[frames.clone()]
                .iter()
                .map(|both| both[side])
                .collect();
            let toe = standing(&soles.iter().map(|sole| sole.toe).collect::<Vec<_>>());
            let heel = standing(&soles.iter().map(|sole| sole.heel).collect::<Vec<_>>());
            for (frame, both) in contacts[frames.clone()].iter_mut().enumerate() {
                both[side] = match (toe[frame], heel[frame]) {
                    (true, _) => FootContact::Toe,
                    (false, true) => FootContact::Heel,
                    (false, false) => FootContact::Air,
                };
            }
        }
    }
    contacts
}

/// Whether a point of a sole stands, frame by frame.
fn standing(points: &[Vec3]) -> Vec<bool> {
    let mut heights: Vec<f32> = points.iter().map(|point| point.y).collect();
    heights.sort_by(f32::total_cmp);
    let ground = heights[heights.len() / 10];
    let last = points.len() - 1;
    let slow: Vec<bool> = (0..points.len())
        .map(|frame| {
            let (before, after) = (frame.saturating_sub(1), (frame + 1).min(last));
            let moved = points[after].distance(points[before]);
            moved * RATE < SPEED * (after - before) as f32 && points[frame].y < ground + HEIGHT
        })
        .collect();
    (0..slow.len())
        .map(|frame| {
            let around = frame.saturating_sub(AROUND)..=(frame + AROUND).min(last);
            let (count, for_it) = (around.clone().count(), around.filter(|&f| slow[f]).count());
            2 * for_it > count
        })
        .collect()
}
