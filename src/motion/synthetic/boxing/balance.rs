//! Balance: how the centre of mass moves for feet that are where they are.
//!
//! A body of constant height whose weight a point on the ground bears falls away from that point as
//! an inverted pendulum does. The one motion of the centre of mass that never falls, whatever the
//! point does, is a mean of the point over past and future, whose weights fade exponentially: so the
//! body leans into a step before it takes it (Kajita et al., 2003, in closed form).

use super::choreography::Choreography;
use super::habits::Habits;
use crate::motion::RATE;
use crate::motion::synthetic::figure::*;
use glam::Vec3;

/// How fast the pendulum falls (1/s): the root of gravity over the height of the centre of mass.
const FALL: f32 = 3.4;
/// Frames beyond a clip's end that the balance of its last frame depends on.
pub const AFTERMATH: usize = 45;

/// Parts of the body: between two joints, at a share of the way, so many kilograms.
const PARTS: [(usize, usize, f32, f32); 15] = [
    (HIPS, SPINE[1], 0.5, 10.0),
    (SPINE[2], NECK, 0.4, 12.0),
    (NECK, HEAD, 1.7, 3.9),
    (ARM[0], FORE_ARM[0], 0.5, 1.5),
    (FORE_ARM[0], HAND[0], 0.48, 1.0),
    (FORE_ARM[0], HAND[0], 1.0, 0.5),
    (ARM[1], FORE_ARM[1], 0.5, 1.5),
    (FORE_ARM[1], HAND[1], 0.48, 1.0),
    (FORE_ARM[1], HAND[1], 1.0, 0.5),
    (UP_LEG[0], LEG[0], 0.5, 4.5),
    (LEG[0], FOOT[0], 0.48, 3.0),
    (FOOT[0], TOE[0], 0.4, 1.0),
    (UP_LEG[1], LEG[1], 0.5, 4.5),
    (LEG[1], FOOT[1], 0.48, 3.0),
    (FOOT[1], TOE[1], 0.4, 1.0),
];

/// Centre of mass of joints at these positions (m).
pub fn centre_of_mass(at: &[Vec3]) -> Vec3 {
    let mass: f32 = PARTS.iter().map(|part| part.3).sum();
    let parts = PARTS.iter();
    let moment: Vec3 = parts
        .map(|&(from, to, share, mass)| at[from].lerp(at[to], share) * mass)
        .sum();
    moment / mass
}

/// Where the centre of mass is over the ground at each frame.
pub fn track(plan: &Choreography, habits: &Habits, frames: usize) -> Vec<Vec3> {
    let mut track: Vec<Vec3> = (0..frames + AFTERMATH)
        .map(|frame| bearing_point(plan, habits, frame as f32 / RATE))
        .collect();
    let keep = (-FALL / RATE).exp();
    smooth(track.iter_mut(), keep);
    smooth(track.iter_mut().rev(), keep);
    track.truncate(frames);
    track
}

/// Each place becomes a mean of those before it.
fn smooth<'a>(places: impl Iterator<Item = &'a mut Vec3>, keep: f32) {
    let mut mean = None;
    for place in places {
        let before = *mean.get_or_insert(*place);
        *place = place.lerp(before, keep);
        mean = Some(*place);
    }
}

/// The point of the ground that bears the weight.
fn bearing_point(plan: &Choreography, habits: &Habits, time: f32) -> Vec3 {
    let left = (plan.weight.at(time) + habits.shift(time)).clamp(0.1, 0.9);
    let [a, b] = &plan.feet;
    let loads = [left * a.bearing(time), (1.0 - left) * b.bearing(time)];
    let share = loads[1] / (loads[0] + loads[1]);
    a.centre(time).lerp(b.centre(time), share)
}
