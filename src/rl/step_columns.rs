//! The columns of one step, for environments around environments.

use crate::env::{EnvSpec, Transition};
use crate::gpu::{Array, Device};
use crate::kernels::learn::{keep_first_end, sum_decision};
use crate::nn::rows;

/// What one step of inner environments leaves, `[rows]`; of its final observations `[rows][observation]`.
pub(in crate::rl) struct StepColumns {
    pub reward: Array,
    pub style_reward: Array,
    pub termination: Array<u32>,
    pub group: Array<u32>,
    pub final_observation: Array,
}

impl StepColumns {
    /// Room for so many rows, with observations of so many numbers.
    pub fn new(device: &Device, rows: usize, observation: usize) -> Self {
        StepColumns {
            reward: Array::zeroed(device, rows),
            style_reward: Array::zeroed(device, rows),
            termination: Array::zeroed(device, rows),
            group: Array::zeroed(device, rows),
            final_observation: Array::zeroed(device, rows * observation),
        }
    }

    /// The columns as a step fills them.
    pub fn transition(&mut self) -> Transition<'_> {
        Transition {
            step: 0,
            reward: &mut self.reward,
            style_reward: &mut self.style_reward,
            termination: &mut self.termination,
            group: &mut self.group,
            final_observation: &mut self.final_observation,
        }
    }

    /// Rows by their numbers.
    pub fn gather(&self, device: &Device, numbers: &Array<u32>) -> StepColumns {
        let real = |column: &Array| rows::gather(device, column, 1, numbers);
        let whole = |column: &Array<u32>| rows::gather(device, column, 1, numbers);
        let observation = self.final_observation.len() / self.reward.len();
        let last = &self.final_observation;
        StepColumns {
            reward: real(&self.reward),
            style_reward: real(&self.style_reward),
            termination: whole(&self.termination),
            group: whole(&self.group),
            final_observation: rows::gather(device, last, observation, numbers),
        }
    }

    /// Takes the step, of this number and with such a share in the reward, into a transition of environments with
    /// the dimensions `spec`.
    pub fn count(
        &self,
        device: &Device,
        spec: &EnvSpec,
        step: usize,
        reward_share: f32,
        whole: &mut Transition,
    ) {
        self.keep_first_end(device, spec, step, whole);
        let params = sum_decision::Params {
            rows: spec.rows() as u32,
            at: (whole.step * spec.rows()) as u32,
            step: step as u32,
            reward_share,
        };
        match device {
            Device::Cpu => sum_decision::twin(
                self.reward.host(),
                self.style_reward.host(),
                self.termination.host(),
                self.group.host(),
                whole.reward.host_mut(),
                whole.style_reward.host_mut(),
                whole.termination.host_mut(),
                whole.group.host_mut(),
                &params,
            ),
            Device::Gpu(gpu) => sum_decision::launch(
                gpu,
                self.reward.buffer(),
                self.style_reward.buffer(),
                self.termination.buffer(),
                self.group.buffer(),
                whole.reward.buffer(),
                whole.style_reward.buffer(),
                whole.termination.buffer(),
                whole.group.buffer(),
                &params,
            ),
        }
    }

    /// Keeps the final observations of the transition's first ends.
    fn keep_first_end(&self, device: &Device, spec: &EnvSpec, step: usize, whole: &mut Transition) {
        let observation = spec.observation.dim();
        let params = keep_first_end::Params {
            rows: spec.rows() as u32,
            observation: observation as u32,
            at: (whole.step * spec.rows()) as u32,
            final_at: (spec.final_row(whole.step) * observation) as u32,
            step: step as u32,
        };
        match device {
            Device::Cpu => keep_first_end::twin(
                self.termination.host(),
                whole.termination.host(),
                self.final_observation.host(),
                whole.final_observation.host_mut(),
                &params,
            ),
            Device::Gpu(gpu) => keep_first_end::launch(
                gpu,
                self.termination.buffer(),
                whole.termination.buffer(),
                self.final_observation.buffer(),
                whole.final_observation.buffer(),
                &params,
            ),
        }
    }
}
