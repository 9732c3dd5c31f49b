//! Recorded motion as start states, and as a discriminator sees it.

use super::starts::lowest_point;
use super::task::{DT, KEY_BODIES, characters};
use crate::env::demonstrations::Demonstrations;
use crate::kernels::physics::proprioception;
use crate::kernels::rng::{random4, uniform01};
use crate::physics::kinematics::{kinematics, velocities};
use crate::physics::model::Model;
use crate::physics::motion_library::MotionLibrary;
use crate::physics::pose::Pose;
use crate::physics::spatial::Spatial;
use rayon::prelude::*;

/// Start states drawn from a library.
const START_STATES: u32 = 4096;
/// Stream of the start states.
const STREAM: u32 = 0x4d4f_5449;
/// Height of a start's feet above the ground, m: on it, rounding would decide whether they touch it.
const CLEARANCE: f32 = 1e-3;

/// What a body, the first agent, observes of itself, `[style]`, at positions `q` and velocities `v`.
pub fn observe(model: &Model, q: &[f32], v: &[f32]) -> Vec<f32> {
    let mut poses = vec![Pose::default(); model.bodies.len()];
    let mut axes = vec![Spatial::ZERO; model.nv()];
    let mut speeds = vec![Spatial::ZERO; model.bodies.len()];
    kinematics(model, q, &mut poses, &mut axes);
    velocities(model, v, &axes, &mut speeds);
    let mut out = vec![0.0; proprioception::width(model, 0, KEY_BODIES.len())];
    let characters = characters(model);
    let first = &characters[1..][..1 + KEY_BODIES.len()];
    proprioception::observe(model, q, v, &poses, &speeds, first, &mut out);
    out
}

/// Positions and velocities `[n][nq + nv]` at random times of a library's motions, by weight, lifted out of
/// the ground.
pub fn start_states(library: &MotionLibrary, seed: u32) -> Vec<f32> {
    let state = |start: u32| {
        let (motion, time) = sample_moment(library, seed, start);
        let (q, v) = library.at(motion, time);
        [lifted(library.model(), &q), v].concat()
    };
    let states: Vec<Vec<f32>> = (0..START_STATES).into_par_iter().map(state).collect();
    states.concat()
}

/// The motion and the time, s, of the start state of this number.
pub fn sample_moment(library: &MotionLibrary, seed: u32, start: u32) -> (usize, f32) {
    let [motion, time, ..] = random4(seed, start, 0, STREAM);
    library.sample([uniform01(motion), uniform01(time)])
}

/// Positions `q` with the feet lifted out of the ground.
pub fn lifted(model: &Model, q: &[f32]) -> Vec<f32> {
    let feet = ["right_foot", "left_foot"].map(|name| model.body(name).expect("a foot"));
    let mut q = q.to_vec();
    q[2] += (CLEARANCE - lowest_point(model, &feet, &q)).max(0.0);
    q
}

/// Two moments a step apart from every frame of a library's motions on, and behind them a `latent` for the motion and
/// the window of these numbers; empty if there are none.
pub fn demonstrations(
    library: &MotionLibrary,
    latent: impl Fn(usize, usize) -> Vec<f32> + Sync,
) -> Demonstrations {
    let model = library.model();
    let mut moments = Vec::new();
    let mut weights = Vec::new();
    for (number, motion) in library.motions().iter().enumerate() {
        let times = (0..motion.frames).map(|frame| frame as f32 / motion.rate);
        let times: Vec<f32> = times
            .filter(|time| time + DT <= motion.seconds() + 1e-4)
            .collect();
        let weight = f64::from(library.share(number)) / times.len().max(1) as f64;
        weights.extend(times.iter().map(|_| weight));
        moments.extend(times.into_iter().map(|time| (number, time)));
    }
    let window = |(number, &(motion, time)): (usize, &(usize, f32))| {
        let moment = |time: f32| {
            let (q, v) = library.at(motion, time);
            observe(model, &q, &v)
        };
        [moment(time), moment(time + DT), latent(motion, number)].concat()
    };
    let windows: Vec<Vec<f32>> = moments.par_iter().enumerate().map(window).collect();
    let dim = windows.first().map_or(0, Vec::len);
    Demonstrations::new(dim, windows.concat(), &weights)
}

/// The mean over a library, by weight, of an action that keeps the body as it is.
pub fn mean_action(library: &MotionLibrary) -> Vec<f32> {
    let model = library.model();
    let mut mean = vec![0.0; model.nu()];
    for (number, motion) in library.motions().iter().enumerate() {
        let weight = library.share(number) / motion.frames as f32;
        for frame in 0..motion.frames {
            let action = super::action::rest_action(model, motion.q(frame));
            mean.iter_mut()
                .zip(&action)
                .for_each(|(mean, own)| *mean += weight * own);
        }
    }
    mean
}
