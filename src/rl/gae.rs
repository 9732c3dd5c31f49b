//! Generalised advantage estimation over a rollout, on either device.

use super::rollout::Rollout;
use crate::gpu::{Array, Device};
use crate::kernels::learn::gae::{Params, launch, twin};

/// Values that the critic gives to what lies behind a rollout, normalised.
pub struct Bootstrap {
    /// `[rows]`, of the observation after the last step.
    pub next_value: Array,
    /// `[final_steps][rows]`, of the final observations.
    pub final_value: Array,
}

/// Fills in the advantages and returns of a rollout. `scale` begins with the mean and standard
/// deviation that undo the normalisation of values.
pub fn gae(
    device: &Device,
    rollout: &mut Rollout,
    bootstrap: &Bootstrap,
    scale: &Array,
    gamma: f32,
    lambda: f32,
) {
    let params = Params {
        rows: rollout.spec.rows() as u32,
        steps: rollout.steps as u32,
        gamma,
        lambda,
        bootstrap: rollout.spec.bootstrap,
        final_steps: rollout.spec.final_steps(rollout.steps) as u32,
    };
    match device {
        Device::Cpu => twin(
            rollout.reward.host(),
            rollout.termination.host(),
            rollout.log_prob_and_value.host(),
            bootstrap.next_value.host(),
            bootstrap.final_value.host(),
            scale.host(),
            rollout.advantage_and_return.host_mut(),
            &params,
        ),
        Device::Gpu(gpu) => launch(
            gpu,
            rollout.reward.buffer(),
            rollout.termination.buffer(),
            rollout.log_prob_and_value.buffer(),
            bootstrap.next_value.buffer(),
            bootstrap.final_value.buffer(),
            scale.buffer(),
            rollout.advantage_and_return.buffer(),
            &params,
        ),
    }
}
