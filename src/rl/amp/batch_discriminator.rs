//! A discriminator that learns no more, on a device.

use super::{LatentUse, style};
use crate::gpu::{Array, Device};
use crate::kernels::learn::style_reward;
use crate::nn::{Engine, RunningMeanStd, rows};

/// A discriminator that learns no more, on a device: it rewards a whole batch of windows at once.
pub struct BatchDiscriminator {
    pub(super) device: Device,
    pub(super) engine: Engine,
    pub(super) parameters: Array,
    pub(super) normalizer: RunningMeanStd,
    pub(super) latents: LatentUse,
    /// `[rows][outputs]`
    pub(super) outputs: Array,
    pub(super) params: style_reward::Params,
}

impl BatchDiscriminator {
    /// Writes the style rewards, `[rows]`, of windows, `[rows][2 style]`, under latents, `[rows][latent]`, which count
    /// where they are shown.
    pub fn reward(&mut self, windows: &Array, latents: &Array, reward: &mut Array) {
        let rows = self.params.samples as usize;
        let mut seen = match self.latents.shown() {
            0 => windows.clone(),
            dim => {
                let width = windows.len() / rows;
                rows::beside(&self.device, &[(windows, width), (latents, dim)])
            }
        };
        self.normalizer.normalize_in_place(&mut seen, rows);
        let (parameters, outputs) = (&self.parameters, &mut self.outputs);
        self.engine
            .forward(0, parameters, &seen, 0, rows, outputs, 0);
        style::reward(&self.device, outputs, reward, &self.params);
    }
}
