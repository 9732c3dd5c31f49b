//! How well a policy stands: a number of episodes, played to their end on the CPU.

use super::common::Common;
use super::cpu::CpuStand;
use super::task::{DT, Stand};
use crate::env::vec_env::{Transition, VecEnv};
use crate::gpu::Array;
use crate::kernels::humanoid::stand_reward::{STEPS, UPRIGHTNESS};
use crate::kernels::termination;
use crate::physics::motion_clip::MotionClip;
use crate::physics::simulator::{STEP_RATE, SUBSTEPS};
use serde::Serialize;

/// Steps a second.
const RATE: f32 = STEP_RATE / SUBSTEPS as f32;

/// A policy's mean: actions `[rows][action]` of observations `[rows][observation]`.
pub type MeanPolicy<'a> = dyn Fn(&[f32]) -> Vec<f32> + 'a;

/// How a policy fared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StandReport {
    /// Episodes played.
    pub episodes: usize,
    /// Fraction of the episodes that did not end by a fall.
    pub survival: f64,
    /// Mean length of an episode, s.
    pub mean_episode_s: f64,
    /// Mean over all steps of the cosine between the torso's up axis and the world's.
    pub mean_uprightness: f64,
}

/// Environments whose first episodes have their full length.
fn opened(stand: &Stand, episodes: usize, seed: u32) -> CpuStand {
    let limits = vec![stand.episode_steps() as f32; episodes];
    CpuStand::new(Common::new(stand, 0..episodes, seed), &limits)
}

/// Steps environments one episode long, and shows each step to `after`, until that wants no more.
fn play(
    envs: &mut CpuStand,
    policy: &MeanPolicy,
    mut after: impl FnMut(&CpuStand, &[u32]) -> bool,
) {
    let (count, dim) = (envs.spec().rows(), envs.spec().observation.dim());
    let mut observation = Array::Host(vec![0.0; count * dim]);
    let mut reward = Array::Host(vec![0.0; count]);
    let mut ends = Array::Host(vec![termination::RUNNING; count]);
    let mut last = Array::Host(vec![0.0; count * dim]);
    for _ in 0..envs.common.stand.episode_steps() {
        envs.observe(&mut observation, 0);
        let action = Array::Host(policy(observation.host()));
        let out = Transition {
            step: 0,
            reward: &mut reward,
            termination: &mut ends,
            final_observation: &mut last,
        };
        envs.step(&action, 0, out);
        if !after(envs, ends.host()) {
            return;
        }
    }
}

/// Plays `episodes` episodes, whose starts and pushes depend on `seed` alone.
pub fn evaluate(stand: &Stand, policy: &MeanPolicy, episodes: usize, seed: u32) -> StandReport {
    let mut ends = vec![termination::RUNNING; episodes];
    let (mut steps, mut upright) = (0.0, 0.0);
    play(&mut opened(stand, episodes, seed), policy, |envs, now| {
        for (env, &end) in now.iter().enumerate() {
            if ends[env] == termination::RUNNING && end != termination::RUNNING {
                ends[env] = end;
                steps += f64::from(envs.episodes[env][STEPS]);
                upright += f64::from(envs.episodes[env][UPRIGHTNESS]);
            }
        }
        ends.contains(&termination::RUNNING)
    });
    let up = ends.iter().filter(|&&end| end == termination::TRUNCATED);
    StandReport {
        episodes,
        survival: up.count() as f64 / episodes.max(1) as f64,
        mean_episode_s: steps * f64::from(DT) / episodes.max(1) as f64,
        mean_uprightness: upright / f64::max(steps, 1.0),
    }
}

/// The motion of one episode, up to its end or its fall.
pub fn record(stand: &Stand, policy: &MeanPolicy, seed: u32) -> MotionClip {
    let mut envs = opened(stand, 1, seed);
    let mut q = envs.batch.worlds[0].state.q.clone();
    play(&mut envs, policy, |envs, ends| {
        let running = ends[0] == termination::RUNNING;
        if running {
            q.extend(&envs.batch.worlds[0].state.q);
        }
        running
    });
    MotionClip::new("stand", &envs.common.batch.model, RATE, q)
}
