//! Whole episodes on the CPU, under a driver.

use super::cpu::CpuHumanoidEnv;
use super::rules::RATE;
use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::env::vec_env::{Transition, VecEnv};
use crate::gpu::Array;
use crate::kernels::termination;
use crate::physics::motion_clip::MotionClip;

/// Steps environments one episode long, under a driver in some `state`. `after` is shown every step, with how it
/// ended for each agent and what the driver remembers, and says whether to go on.
pub fn play(
    envs: &mut CpuHumanoidEnv,
    driver: &dyn BodyDriver,
    state: DriverState,
    after: impl FnMut(&CpuHumanoidEnv, &[u32], &mut DriverState) -> bool,
) {
    let act = |observation: &[f32], state: &mut DriverState| driver.act(observation, state);
    play_by(envs, act, state, after);
}

/// [`play`] by whoever decides on actions `[rows][action]` for observations `[rows][observation]`, and remembers
/// `state`.
pub fn play_by<S>(
    envs: &mut CpuHumanoidEnv,
    mut act: impl FnMut(&[f32], &mut S) -> Vec<f32>,
    mut state: S,
    mut after: impl FnMut(&CpuHumanoidEnv, &[u32], &mut S) -> bool,
) {
    let mut step = DrivenStep::new(envs);
    for _ in 0..envs.task().rules().steps() {
        step.play_by(envs, |observation| act(observation, &mut state));
        if !after(envs, step.ends.host(), &mut state) {
            return;
        }
    }
}

/// A step of environments under a driver.
pub struct DrivenStep {
    /// What was observed before it, `[rows][observation]`.
    pub observation: Array,
    /// `[rows]`
    pub reward: Array,
    /// How it ended, `[rows]`.
    pub ends: Array<u32>,
    style_reward: Array,
    group: Array<u32>,
    last: Array,
}

impl DrivenStep {
    /// Before the first step.
    pub fn new(envs: &CpuHumanoidEnv) -> DrivenStep {
        let (count, dim) = (envs.spec().rows(), envs.spec().observation.dim());
        DrivenStep {
            observation: Array::Host(vec![0.0; count * dim]),
            reward: Array::Host(vec![0.0; count]),
            ends: Array::Host(vec![termination::RUNNING; count]),
            style_reward: Array::Host(vec![0.0; count]),
            group: Array::Host(vec![0; count]),
            last: Array::Host(vec![0.0; count * dim]),
        }
    }

    /// Plays the next step; `state` is the driver's.
    pub fn play(
        &mut self,
        envs: &mut CpuHumanoidEnv,
        driver: &dyn BodyDriver,
        state: &mut DriverState,
    ) {
        self.play_by(envs, |observation| driver.act(observation, state));
    }

    /// [`DrivenStep::play`] by whoever decides on actions `[rows][action]` for observations
    /// `[rows][observation]`.
    pub fn play_by(&mut self, envs: &mut CpuHumanoidEnv, act: impl FnOnce(&[f32]) -> Vec<f32>) {
        envs.observe(&mut self.observation, 0);
        let action = Array::Host(act(self.observation.host()));
        let out = Transition {
            step: 0,
            reward: &mut self.reward,
            style_reward: &mut self.style_reward,
            termination: &mut self.ends,
            group: &mut self.group,
            final_observation: &mut self.last,
        };
        envs.step(&action, 0, out);
    }
}

/// How the first episode of each agent went.
pub struct Episodes {
    /// How it ended, `[rows]`.
    pub ends: Vec<u32>,
    /// The sums of its statistics, `[rows][stats]`.
    pub sums: Vec<Vec<f32>>,
}

/// Plays one episode of each environment to its end, under a driver in some `state`. `after` is shown every step,
/// with the agents still in their first episode and what the driver remembers.
pub fn play_episodes(
    envs: &mut CpuHumanoidEnv,
    driver: &dyn BodyDriver,
    state: DriverState,
    after: impl FnMut(&CpuHumanoidEnv, &[bool], &mut DriverState),
) -> Episodes {
    let act = |observation: &[f32], state: &mut DriverState| driver.act(observation, state);
    play_episodes_by(envs, act, state, after)
}

/// [`play_episodes`] by whoever decides on actions `[rows][action]` for observations `[rows][observation]`, and
/// remembers `state`.
pub fn play_episodes_by<S>(
    envs: &mut CpuHumanoidEnv,
    act: impl FnMut(&[f32], &mut S) -> Vec<f32>,
    state: S,
    mut after: impl FnMut(&CpuHumanoidEnv, &[bool], &mut S),
) -> Episodes {
    let count = envs.spec().rows();
    let mut found = Episodes {
        ends: vec![termination::RUNNING; count],
        sums: vec![Vec::new(); count],
    };
    let mut running = vec![true; count];
    play_by(envs, act, state, |envs, ends, state| {
        for (row, &end) in ends.iter().enumerate() {
            if running[row] && end != termination::RUNNING {
                let stats = envs.stat_names().len();
                let episode = &envs.episodes[row];
                running[row] = false;
                found.ends[row] = end;
                found.sums[row] = episode[episode.len() - stats..].to_vec();
            }
        }
        after(envs, &running, state);
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

/// The motion of one episode of the first environment, up to its end; `after` is shown every step, and whether the
/// episode goes on after it.
pub fn record(
    envs: &mut CpuHumanoidEnv,
    driver: &dyn BodyDriver,
    name: &str,
    mut after: impl FnMut(&CpuHumanoidEnv, bool),
) -> MotionClip {
    let mut q = envs.batch.worlds[0].state.q.clone();
    play(envs, driver, DriverState::default(), |envs, ends, _| {
        let running = ends[0] == termination::RUNNING;
        if running {
            q.extend(&envs.batch.worlds[0].state.q);
        }
        after(envs, running);
        running
    });
    MotionClip::new(name, envs.task().model(), RATE, q)
}
