//! The columns that a rollout leaves for learning.

use crate::env::{EnvSpec, Transition, VecEnv};
use crate::gpu::{Array, Device};
use anyhow::Result;

/// One rollout of a part of the environments, time-major: rows of step 0 first.
pub struct Rollout {
    /// Dimensions of the part's environments.
    pub spec: EnvSpec,
    /// Steps of every environment.
    pub steps: usize,
    /// `[steps][rows][observation]`; normalised once it has been played, where observations are.
    pub observation: Array,
    /// `[steps][rows][action]`
    pub action: Array,
    /// `[steps][rows][action]`, the policy's mean when it acted.
    pub mean: Array,
    /// Logarithm of the action's density, `[steps][rows]`, then the critic's normalised outputs,
    /// `[steps][rows][streams]`.
    pub log_prob_and_value: Array,
    /// `[steps][rows]`, of the task.
    pub reward: Array,
    /// `[steps][rows]`, of the style, where there is one: the environments', or a learner's discriminator's.
    pub style_reward: Array,
    /// `[steps][rows]`, of being found by an encoder, where there is one.
    pub skill_reward: Array,
    /// `[steps][rows]`, see [`crate::env::termination`].
    pub termination: Array<u32>,
    /// `[steps][rows]`, see [`Transition::group`].
    pub group: Array<u32>,
    /// `[final_steps][rows][observation]`
    pub final_observation: Array,
    /// `[rows][observation]`, after the last step.
    pub next_observation: Array,
    /// `[2][steps][rows][streams]`: advantages and returns, in units of reward.
    pub advantage_and_return: Array,
}

impl Rollout {
    /// Columns for `steps` steps of environments on `device`, whose rewards are so many streams.
    pub fn new(device: &Device, spec: &EnvSpec, steps: usize, streams: usize) -> Self {
        let (rows, observation) = (spec.rows(), spec.observation.dim());
        let samples = steps * rows;
        let zeros = |len: usize| Array::zeroed(device, len);
        Rollout {
            spec: *spec,
            steps,
            observation: zeros(samples * observation),
            action: zeros(samples * spec.action),
            mean: zeros(samples * spec.action),
            log_prob_and_value: zeros((1 + streams) * samples),
            reward: zeros(samples),
            style_reward: zeros(samples),
            skill_reward: zeros(samples),
            termination: Array::zeroed(device, samples),
            group: Array::zeroed(device, samples),
            final_observation: zeros(spec.final_steps(steps) * rows * observation),
            next_observation: zeros(rows * observation),
            advantage_and_return: zeros(2 * streams * samples),
        }
    }

    /// Samples of all steps.
    pub fn samples(&self) -> usize {
        self.steps * self.spec.rows()
    }

    /// Plays one step of the environments whose actions are known.
    pub fn step(&mut self, env: &mut dyn VecEnv, step: usize) {
        let at = step * self.spec.rows() * self.spec.action;
        let transition = Transition {
            step,
            reward: &mut self.reward,
            style_reward: &mut self.style_reward,
            termination: &mut self.termination,
            group: &mut self.group,
            final_observation: &mut self.final_observation,
        };
        env.step(&self.action, at, transition);
    }

    /// Writes the environments' present observation into the row of a step, or behind the last.
    pub fn observe(&mut self, env: &mut dyn VecEnv, step: usize) {
        let at = step * self.spec.rows() * self.spec.observation.dim();
        match step < self.steps {
            true => env.observe(&mut self.observation, at),
            false => env.observe(&mut self.next_observation, 0),
        }
    }
}

/// Refuses rollouts that one buffer of `device` cannot hold.
///
/// # Errors
/// Says what is too large and by how much.
pub fn check_fits(device: &Device, spec: &EnvSpec, steps: usize) -> Result<()> {
    let numbers = steps * spec.rows() * spec.observation.dim();
    device
        .holds("observations of an update", numbers)
        .map_err(|error| anyhow::anyhow!("{error}: use a smaller --envs or ppo.rollout_length"))
}
