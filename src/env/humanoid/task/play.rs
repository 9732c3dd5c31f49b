//! Whole episodes on the CPU, played by a policy's mean.

use super::cpu::CpuHumanoidEnv;
use super::rules::RATE;
use crate::env::vec_env::{Transition, VecEnv};
use crate::gpu::Array;
use crate::kernels::termination;
use crate::physics::motion_clip::MotionClip;

/// A policy's mean: actions `[rows][action]` of observations `[rows][observation]`.
pub type MeanPolicy<'a> = dyn Fn(&[f32]) -> Vec<f32> + 'a;

/// Steps environments one episode long. `after` is shown every step, with how it ended for each, and says
/// whether to go on.
pub fn play(
    envs: &mut CpuHumanoidEnv,
    policy: &MeanPolicy,
    mut after: impl FnMut(&CpuHumanoidEnv, &[u32]) -> bool,
) {
    let (count, dim) = (envs.spec().rows(), envs.spec().observation.dim());
    let mut observation = Array::Host(vec![0.0; count * dim]);
    let mut reward = Array::Host(vec![0.0; count]);
    let mut ends = Array::Host(vec![termination::RUNNING; count]);
    let mut group = Array::Host(vec![0; count]);
    let mut last = Array::Host(vec![0.0; count * dim]);
    for _ in 0..envs.task().rules().steps() {
        envs.observe(&mut observation, 0);
        let action = Array::Host(policy(observation.host()));
        let out = Transition {
            step: 0,
            reward: &mut reward,
            termination: &mut ends,
            group: &mut group,
            final_observation: &mut last,
        };
        envs.step(&action, 0, out);
        if !after(envs, ends.host()) {
            return;
        }
    }
}

/// How the first episode of each environment went.
pub struct Episodes {
    /// How it ended, `[envs]`.
    pub ends: Vec<u32>,
    /// The sums of its statistics, `[envs][stats]`.
    pub sums: Vec<Vec<f32>>,
}

/// Plays one episode of each environment to its end. `after` is shown every step, with those still in
/// their first episode.
pub fn play_episodes(
    envs: &mut CpuHumanoidEnv,
    policy: &MeanPolicy,
    mut after: impl FnMut(&CpuHumanoidEnv, &[bool]),
) -> Episodes {
    let count = envs.spec().envs;
    let mut found = Episodes {
        ends: vec![termination::RUNNING; count],
        sums: vec![Vec::new(); count],
    };
    let mut running = vec![true; count];
    play(envs, policy, |envs, ends| {
        for (env, &end) in ends.iter().enumerate() {
            if running[env] && end != termination::RUNNING {
                let stats = envs.stat_names().len();
                let episode = &envs.episodes[env];
                running[env] = false;
                found.ends[env] = end;
                found.sums[env] = episode[episode.len() - stats..].to_vec();
            }
        }
        after(envs, &running);
        running.contains(&true)
    });
    found
}

impl Episodes {
    /// Mean over the episodes of a sum by its index.
    pub fn mean(&self, stat: usize) -> f64 {
        let sums = self.sums.iter().filter_map(|sums| sums.get(stat));
        sums.map(|&sum| f64::from(sum)).sum::<f64>() / self.ends.len().max(1) as f64
    }

    /// Fraction of the episodes that ended in one of these ways, `1 << termination`.
    pub fn fraction(&self, ends: u32) -> f64 {
        let such = self.ends.iter().filter(|&&end| ends >> end & 1 == 1);
        such.count() as f64 / self.ends.len().max(1) as f64
    }
}

/// The motion of one episode of the first environment, up to its end.
pub fn record(envs: &mut CpuHumanoidEnv, policy: &MeanPolicy, name: &str) -> MotionClip {
    let mut q = envs.batch.worlds[0].state.q.clone();
    play(envs, policy, |envs, ends| {
        let running = ends[0] == termination::RUNNING;
        if running {
            q.extend(&envs.batch.worlds[0].state.q);
        }
        running
    });
    MotionClip::new(name, envs.task().model(), RATE, q)
}
