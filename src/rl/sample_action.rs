//! Actions drawn from the policy's Gaussian, on either device.

use super::rollout::Rollout;
use crate::gpu::{Array, Device};
use crate::kernels::learn::sample_action::{Params, launch, twin};

/// Draws the actions of a step of `rollout` from its means, with the logarithm of their densities.
pub fn sample_action(device: &Device, log_std: &Array, rollout: &mut Rollout, params: &Params) {
    match device {
        Device::Cpu => twin(
            rollout.mean.host(),
            log_std.host(),
            rollout.action.host_mut(),
            rollout.log_prob_and_value.host_mut(),
            params,
        ),
        Device::Gpu(gpu) => launch(
            gpu,
            rollout.mean.buffer(),
            log_std.buffer(),
            rollout.action.buffer(),
            rollout.log_prob_and_value.buffer(),
            params,
        ),
    }
}
