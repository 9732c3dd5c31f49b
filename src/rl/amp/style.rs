//! What moves in a style: windows and their reward, on either device.

use crate::gpu::{Array, Device};
use crate::kernels::learn::{style_reward, style_windows};

/// Columns of observations, see [`style_windows`].
pub struct Moments<'a> {
    pub observation: &'a Array,
    pub next_observation: &'a Array,
    pub final_observation: &'a Array,
    pub termination: &'a Array<u32>,
}

/// Writes the windows of steps.
pub fn windows(
    device: &Device,
    moments: &Moments,
    windows: &mut Array,
    params: &style_windows::Params,
) {
    match device {
        Device::Cpu => style_windows::twin(
            moments.observation.host(),
            moments.next_observation.host(),
            moments.final_observation.host(),
            moments.termination.host(),
            windows.host_mut(),
            params,
        ),
        Device::Gpu(gpu) => style_windows::launch(
            gpu,
            moments.observation.buffer(),
            moments.next_observation.buffer(),
            moments.final_observation.buffer(),
            moments.termination.buffer(),
            windows.buffer(),
            params,
        ),
    }
}

/// Writes the rewards for a discriminator's outputs.
pub fn reward(device: &Device, output: &Array, reward: &mut Array, params: &style_reward::Params) {
    match device {
        Device::Cpu => style_reward::twin(output.host(), reward.host_mut(), params),
        Device::Gpu(gpu) => style_reward::launch(gpu, output.buffer(), reward.buffer(), params),
    }
}
