//! How well a policy moves as recordings do.

use super::ImitateTask;
use crate::env::humanoid::imitate::pose_track::PoseTrack;
use crate::env::humanoid::task::play::{MeanPolicy, play_episodes};
use crate::env::humanoid::task::{CpuHumanoidEnv, DT};
use crate::kernels::termination;
use crate::physics::motion_library::MotionLibrary;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;

/// Episodes whose poses are compared with the recordings.
const COMPARED: usize = 64;
/// Frames of a stretch that is compared as one: a second.
const STRETCH: usize = 30;
/// A clip is covered if it is nearest to this share of the stretches.
const COVERED: f64 = 0.01;

/// How a policy fared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ImitateReport {
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
}

/// Plays `episodes` episodes, whose starts depend on `seed` alone.
pub fn evaluate(
    task: Arc<ImitateTask>,
    policy: &MeanPolicy,
    episodes: usize,
    seed: u32,
) -> ImitateReport {
    let library = task.library.clone();
    let mut envs = CpuHumanoidEnv::unstaggered(task, 0..episodes, seed);
    let mut tracks: Vec<PoseTrack> = (0..episodes.min(COMPARED))
        .map(|_| PoseTrack::default())
        .collect();
    let mut before: Vec<[f32; 2]> = envs.batch.worlds.iter().map(root_of).collect();
    let (mut way, mut frames) = (0.0, 0usize);
    let found = play_episodes(&mut envs, policy, |envs, running| {
        for (env, world) in envs.batch.worlds.iter().enumerate() {
            let now = root_of(world);
            if running[env] {
                let [x, y] = before[env];
                way += f64::from((now[0] - x).hypot(now[1] - y));
                frames += 1;
                if let Some(track) = tracks.get_mut(env) {
                    track.push(envs.task().model(), &world.state.q);
                }
            }
            before[env] = now;
        }
    });
    let references: Vec<PoseTrack> = (0..library.motions().len())
        .map(|motion| recorded(&library, motion))
        .collect();
    let nearest = nearest_stretches(&tracks, &references);
    let mut hits = vec![0; references.len()];
    nearest.iter().for_each(|(clip, _)| hits[*clip] += 1);
    let enough = (COVERED * nearest.len() as f64).max(1.0);
    let covered = hits.iter().filter(|&&hits| f64::from(hits) >= enough);
    let speed = way / (frames.max(1) as f64 * f64::from(DT));
    ImitateReport {
        episodes,
        survival: found.fraction(1 << termination::TRUNCATED),
        // The third of all statistics.
        mean_episode_s: found.mean(2) * f64::from(DT),
        speed_ratio: speed / mean_speed(&library).max(1e-6),
        dtw_m: nearest.iter().map(|(_, distance)| distance).sum::<f64>()
            / nearest.len().max(1) as f64,
        coverage: covered.count() as f64 / references.len().max(1) as f64,
    }
}

fn root_of(world: &crate::env::humanoid::batch::SimulatedWorld) -> [f32; 2] {
    [world.state.q[0], world.state.q[1]]
}

/// The nearest clip of every stretch of a second, and how far it is, m.
fn nearest_stretches(tracks: &[PoseTrack], references: &[PoseTrack]) -> Vec<(usize, f64)> {
    let stretches: Vec<PoseTrack> = tracks
        .iter()
        .flat_map(|track| track.stretches(STRETCH))
        .collect();
    let nearest = |stretch: &PoseTrack| {
        let distances = references
            .iter()
            .map(|reference| stretch.distance(reference));
        let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.unwrap_or((0, f64::INFINITY))
    };
    stretches.par_iter().map(nearest).collect()
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
