//! Environments of a body as environments of latents.

use super::batch_low_level::BatchLowLevel;
use super::{FrozenLowLevel, STEPS_PER_DECISION};
use crate::container::{Section, SectionError};
use crate::env::{EnvSpec, Transition, VecEnv};
use crate::gpu::{Array, Device};
use crate::kernels::learn::style_windows;
use crate::nn::rows;
use crate::rl::amp::style;
use crate::rl::step_columns::StepColumns;
use anyhow::Result;

/// Environments of a body whose agents act through a frozen low level: an action is a direction on its sphere of
/// latents (see [`low_level_input`](crate::kernels::learn::low_level_input)), by which the low level's mean plays
/// five steps.
///
/// A decision's reward is a fifth of the sum of its steps' rewards, its style reward the mean of what the low
/// level's discriminator gives for its steps. Where a step ends an episode, the decision ends so, and what follows
/// in it does not count: the new episode begins under the old latent. Statistics are the body's: lengths are counted
/// in its steps.
pub struct HighLevelEnv {
    device: Device,
    spec: EnvSpec,
    inner: Box<dyn VecEnv>,
    low_level: BatchLowLevel,
    /// `[rows][action]` of the body.
    action: Array,
    /// `[rows][observation]` before and after the present step; between decisions `before` is what is observed now.
    before: Array,
    after: Array,
    /// The moments before and after the present step, `[rows][2 style]`.
    windows: Array,
    step: StepColumns,
}

impl HighLevelEnv {
    /// Environments around those of a body on the same device.
    ///
    /// # Errors
    /// The low level is of another body, or the device has no room for it.
    pub fn new(
        mut inner: Box<dyn VecEnv>,
        low_level: &FrozenLowLevel,
        device: &Device,
    ) -> Result<Self> {
        let body = *inner.spec();
        let (rows, observation) = (body.rows(), body.observation.dim());
        let spec = low_level.steered(&body).map_err(anyhow::Error::msg)?;
        let mut before = Array::zeroed(device, rows * observation);
        inner.observe(&mut before, 0);
        Ok(HighLevelEnv {
            low_level: BatchLowLevel::new(low_level, device, rows)?,
            action: Array::zeroed(device, rows * body.action),
            before,
            after: Array::zeroed(device, rows * observation),
            windows: Array::zeroed(device, rows * 2 * body.style),
            step: StepColumns::new(device, rows, observation),
            device: device.clone(),
            spec,
            inner,
        })
    }

    /// Plays a step of the inner environments, whose observation is `before`; it leaves `after`.
    fn play(&mut self, latents: &Array, at: usize) {
        let (low_level, action) = (&mut self.low_level, &mut self.action);
        low_level.act(&self.before, latents, at, action);
        self.inner.step(&self.action, 0, self.step.transition());
        self.inner.observe(&mut self.after, 0);
        self.write_windows();
        let reward = &mut self.step.style_reward;
        self.low_level.reward(&self.windows, reward);
    }

    fn write_windows(&mut self) {
        let params = style_windows::Params {
            steps: 1,
            rows: self.spec.rows() as u32,
            observation: self.spec.observation.dim() as u32,
            style: self.spec.style as u32,
            final_steps: 1,
        };
        let moments = style::Moments {
            observation: &self.before,
            next_observation: &self.after,
            final_observation: &self.step.final_observation,
            termination: &self.step.termination,
        };
        style::windows(&self.device, &moments, &mut self.windows, &params);
    }
}

impl VecEnv for HighLevelEnv {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn inner(&self) -> Option<&dyn VecEnv> {
        Some(&*self.inner)
    }

    fn inner_mut(&mut self) -> Option<&mut dyn VecEnv> {
        Some(&mut *self.inner)
    }

    fn rest_action(&self) -> Vec<f32> {
        // No latent keeps a body as it is.
        Vec::new()
    }

    fn observe(&mut self, out: &mut Array, at: usize) {
        rows::replace(&self.device, out, at, &self.before);
    }

    fn step(&mut self, action: &Array, at: usize, mut out: Transition) {
        for step in 0..STEPS_PER_DECISION {
            self.play(action, at);
            let share = 1.0 / STEPS_PER_DECISION as f32;
            self.step
                .count(&self.device, &self.spec, step, share, &mut out);
            std::mem::swap(&mut self.before, &mut self.after);
        }
    }

    fn restart(&mut self, which: &[bool]) -> Result<()> {
        self.inner.restart(which)?;
        self.inner.observe(&mut self.before, 0);
        Ok(())
    }

    fn stat_names(&self) -> &'static [&'static str] {
        self.inner.stat_names()
    }

    fn stats(&mut self, out: &mut Array) {
        self.inner.stats(out);
    }

    fn save(&self, to: &mut Section) -> Result<()> {
        self.inner.save(to)
    }

    fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        self.inner.load(from)?;
        self.inner.observe(&mut self.before, 0);
        Ok(())
    }
}
