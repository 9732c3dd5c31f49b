//! How well a policy finds and topples its target.

use super::PunchTask;
use crate::env::humanoid::task::play::{MeanPolicy, play_episodes};
use crate::env::humanoid::task::{CpuHumanoidEnv, DT};
use crate::kernels::termination::FAILED;
use serde::Serialize;
use std::sync::Arc;

/// How a policy fared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PunchReport {
    /// Episodes played.
    pub episodes: usize,
    /// Fraction of the episodes that did not end by a fall.
    pub survival: f64,
    /// Fraction of the targets that were hit.
    pub hit_rate: f64,
    /// Fraction of the targets that were toppled by a first contact of a fast fist.
    pub fist_rate: f64,
    /// Mean time from the start to the hit, of those that were hit, s.
    pub time_to_hit_mean_s: f64,
    /// Mean angle between facing and wanted facing while the target is far, degrees.
    pub facing_error_deg: f64,
    /// Mean length of an episode, s.
    pub mean_episode_s: f64,
}

/// Plays `episodes` episodes, whose starts depend on `seed` alone.
pub fn evaluate(
    task: Arc<PunchTask>,
    policy: &MeanPolicy,
    episodes: usize,
    seed: u32,
) -> PunchReport {
    let after = f64::from(task.punch().steps_after_hit());
    let mut envs = CpuHumanoidEnv::unstaggered(task, 0..episodes, seed);
    let found = play_episodes(&mut envs, policy, |_, _| ());
    // In the order of the statistics.
    let [steps, hit, fist, far, angle] = [2, 5, 6, 7, 8].map(|stat| found.mean(stat));
    let hits = found.sums.iter().filter(|sums| sums.get(5) == Some(&1.0));
    let times: Vec<f64> = hits.map(|sums| f64::from(sums[2]) - after).collect();
    PunchReport {
        episodes,
        survival: 1.0 - found.fraction(1 << FAILED),
        hit_rate: hit,
        fist_rate: fist,
        time_to_hit_mean_s: times.iter().sum::<f64>() * f64::from(DT) / times.len().max(1) as f64,
        facing_error_deg: (angle / far.max(1e-9)).to_degrees(),
        mean_episode_s: steps * f64::from(DT),
    }
}
