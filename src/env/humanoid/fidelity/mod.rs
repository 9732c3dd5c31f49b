//! How the motion of a policy compares with recordings, whatever its task.
//!
//! A [`FidelityProbe`] watches episodes; its [`FidelityReport`] is the part of an evaluation that all tasks with
//! recordings share. A [`PoseTrack`] is motion as it is compared.

mod pose_track;

use super::batch::SimulatedWorld;
use super::task::play::Episodes;
use super::task::{CpuHumanoidEnv, DT};
use crate::kernels::termination::FAILED;
use crate::physics::drive::{Effort, efforts};
use crate::physics::model::Model;
use crate::physics::motion_library::MotionLibrary;
use crate::physics::simulator::STEP_RATE;
pub use pose_track::PoseTrack;
use rayon::prelude::*;
use serde::Serialize;

/// Episodes whose poses are compared with the recordings.
const COMPARED: usize = 64;
/// Frames of a stretch that is compared as one: a second.
const STRETCH: usize = 30;
/// A clip is covered if it is nearest to this share of the stretches.
const COVERED: f64 = 0.01;

/// How a policy's motion compares with recordings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FidelityReport {
    /// Episodes played.
    pub episodes: usize,
    /// Fraction of the episodes that did not end by a fall.
    pub survival: f64,
    /// Mean length of an episode, s.
    pub mean_episode_s: f64,
    /// Mean speed of the root over the ground against that of the recordings.
    pub speed_ratio: f64,
    /// Mean distance of the bodies, in the root's heading frame, from the nearest recorded stretch of a
    /// second, aligned in time, m.
    pub dtw_m: f64,
    /// Fraction of the clips that are nearest to at least 1 % of the stretches.
    pub coverage: f64,
    /// Entropy of how often each clip is nearest, against that of all being as often so.
    pub coverage_entropy: f64,
    /// Mean mechanical power of the drives, work done on them counted as work, W.
    pub power_w: f64,
}

/// Watches the first episode of each environment.
pub struct FidelityProbe<'a> {
    library: &'a MotionLibrary,
    references: Vec<PoseTrack>,
    tracks: Vec<PoseTrack>,
    /// Where the roots were, m.
    before: Vec<[f32; 2]>,
    distance_m: f64,
    frames: usize,
    /// Sum of the drives' power over the compared frames, W, and their number.
    power_w: f64,
    compared: usize,
}

impl<'a> FidelityProbe<'a> {
    /// A probe of environments at the start of their episodes.
    pub fn new(library: &'a MotionLibrary, envs: &CpuHumanoidEnv) -> Self {
        let worlds = &envs.batch.worlds;
        let motions = 0..library.motions().len();
        FidelityProbe {
            references: motions.map(|motion| recorded(library, motion)).collect(),
            library,
            tracks: vec![PoseTrack::default(); worlds.len().min(COMPARED)],
            before: worlds.iter().map(root_of).collect(),
            distance_m: 0.0,
            frames: 0,
            power_w: 0.0,
            compared: 0,
        }
    }

    /// Takes in a step; `running` says which environments are still in their first episode.
    pub fn observe(&mut self, envs: &CpuHumanoidEnv, running: &[bool]) {
        for (env, world) in envs.batch.worlds.iter().enumerate() {
            let now = root_of(world);
            if running[env] {
                let [x, y] = self.before[env];
                self.distance_m += f64::from((now[0] - x).hypot(now[1] - y));
                self.frames += 1;
                if let Some(track) = self.tracks.get_mut(env) {
                    track.push(envs.task().model(), &world.state.q);
                    self.power_w += power(envs.task().model(), world);
                    self.compared += 1;
                }
            }
            self.before[env] = now;
        }
    }

    /// What came of the episodes.
    pub fn report(&self, found: &Episodes) -> FidelityReport {
        let stretches = self.tracks.iter().flat_map(|track| track.parts(STRETCH));
        let nearest = self.nearest(&stretches.collect::<Vec<_>>());
        let mut counts = vec![0u32; self.references.len()];
        nearest.iter().for_each(|(clip, _)| counts[*clip] += 1);
        let enough = (COVERED * nearest.len() as f64).max(1.0);
        let covered = counts.iter().filter(|&&count| f64::from(count) >= enough);
        let speed = self.distance_m / (self.frames.max(1) as f64 * f64::from(DT));
        let distance: f64 = nearest.iter().map(|(_, distance)| distance).sum();
        FidelityReport {
            episodes: found.ends.len(),
            survival: 1.0 - found.fraction(1 << FAILED),
            // The third of all statistics.
            mean_episode_s: found.mean(2) * f64::from(DT),
            speed_ratio: speed / mean_speed(self.library).max(1e-6),
            dtw_m: distance / nearest.len().max(1) as f64,
            coverage: covered.count() as f64 / counts.len().max(1) as f64,
            power_w: self.power_w / self.compared.max(1) as f64,
            coverage_entropy: entropy(&counts) / (counts.len().max(2) as f64).ln(),
        }
    }

    /// The nearest clip of every stretch of a second, of each environment whose poses are compared.
    pub fn nearest_clips(&self) -> Vec<Vec<usize>> {
        let stretches = self.tracks.iter().map(|track| {
            let stretches: Vec<PoseTrack> = track.parts(STRETCH).collect();
            let nearest = self.nearest(&stretches);
            nearest.into_iter().map(|(clip, _)| clip).collect()
        });
        stretches.collect()
    }

    /// Fraction of poses whose nearest clip is of a kind; `None` without poses, or clips of that kind.
    pub fn share_of_kind(&self, poses: &PoseTrack, kind: &str) -> Option<f64> {
        let is_kind = |motion: usize| self.library.kind(motion) == kind;
        let poses: Vec<PoseTrack> = poses.parts(1).collect();
        if poses.is_empty() || !(0..self.references.len()).any(is_kind) {
            return None;
        }
        let nearest = self.nearest(&poses);
        let such = nearest.iter().filter(|(motion, _)| is_kind(*motion));
        Some(such.count() as f64 / nearest.len() as f64)
    }

    /// The nearest clip of every part, and how far it is, m.
    fn nearest(&self, parts: &[PoseTrack]) -> Vec<(usize, f64)> {
        let nearest = |part: &PoseTrack| {
            let references = self.references.iter();
            let distances = references.map(|reference| part.distance(reference));
            let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            nearest.unwrap_or((0, f64::INFINITY))
        };
        parts.par_iter().map(nearest).collect()
    }
}

/// The entropy of frequencies, nats.
fn entropy(counts: &[u32]) -> f64 {
    let total = f64::from(counts.iter().sum::<u32>().max(1));
    let shares = counts.iter().map(|&count| f64::from(count) / total);
    let terms = shares.filter(|&share| share > 0.0);
    -terms.map(|share| share * share.ln()).sum::<f64>()
}

/// The power of a world's drives at this moment, each counted as positive, W.
fn power(model: &Model, world: &SimulatedWorld) -> f64 {
    let (q, v) = (&world.state.q, &world.state.v);
    let mut drives = vec![Effort::default(); model.nv()];
    efforts(model, q, v, &world.targets, 1.0 / STEP_RATE, &mut drives);
    let limits = model.dofs.iter().map(|dof| dof.drive.map_or(0.0, |drive| drive.limit));
    let powers = drives.iter().zip(limits).zip(v);
    let powers = powers.map(|((drive, limit), speed)| drive.force.clamp(-limit, limit) * speed);
    powers.map(|power| f64::from(power.abs())).sum()
}

fn root_of(world: &SimulatedWorld) -> [f32; 2] {
    [world.state.q[0], world.state.q[1]]
}

/// A motion of a library, a step a frame.
fn recorded(library: &MotionLibrary, motion: usize) -> PoseTrack {
    let mut track = PoseTrack::default();
    let steps = (library.motions()[motion].seconds() / DT).round() as usize;
    for step in 0..=steps {
        let (q, _) = library.at(motion, step as f32 * DT);
        track.push(library.model(), &q);
    }
    track
}

/// The mean speed of the root over the ground, by weight, m/s.
fn mean_speed(library: &MotionLibrary) -> f64 {
    let speed = |number: usize| {
        let motion = &library.motions()[number];
        let steps = (1..motion.frames).map(|frame| {
            let [a, b] = [frame - 1, frame].map(|frame| motion.q(frame));
            f64::from((b[0] - a[0]).hypot(b[1] - a[1]))
        });
        f64::from(library.share(number)) * steps.sum::<f64>() / f64::from(motion.seconds())
    };
    (0..library.motions().len()).map(speed).sum()
}
