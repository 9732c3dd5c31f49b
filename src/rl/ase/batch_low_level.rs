//! A frozen low level on a device.

use super::FrozenLowLevel;
use crate::gpu::{Array, Device};
use crate::kernels::learn::low_level_input;
use crate::nn::{Engine, RunningMeanStd, rows};
use crate::rl::amp::BatchDiscriminator;
use anyhow::Result;

/// A frozen low level on a device, for a batch of bodies.
pub struct BatchLowLevel {
    device: Device,
    engine: Engine,
    parameters: Array,
    normalizer: Option<RunningMeanStd>,
    /// See [`low_level_input`].
    widths: Array<u32>,
    style: usize,
    rows: usize,
    /// What it observed last, `[rows][style + latent]`, and the same normalised.
    input: Array,
    normalized: Array,
    discriminator: BatchDiscriminator,
}

impl BatchLowLevel {
    /// A copy of the low level for so many rows.
    ///
    /// # Errors
    /// The device has no room for it.
    pub fn new(low_level: &FrozenLowLevel, device: &Device, rows: usize) -> Result<Self> {
        let policy = &low_level.policy;
        let actor = policy.networks().actor.clone();
        let parameters = &policy.parameters[actor.span()];
        let widths = low_level.widths();
        let input = rows * widths.iter().sum::<usize>();
        Ok(BatchLowLevel {
            parameters: Array::from_slice(device, parameters),
            engine: Engine::new(device, vec![actor], parameters.len(), 0, rows, 1)?,
            normalizer: policy.normalizer.as_ref().map(|moments| moments.on(device)),
            style: widths[0],
            widths: Array::from_slice(device, &widths.map(|width| width as u32)),
            input: Array::zeroed(device, input),
            normalized: Array::zeroed(device, input),
            discriminator: low_level.discriminator.on(device, rows)?,
            device: device.clone(),
            rows,
        })
    }

    /// Writes mean actions `[rows][action]` to `action`, for bodies that observe `[rows][observation]` and
    /// latents `[rows][latent]`, from the index `at` on, of any length.
    pub fn act(&mut self, observation: &Array, latents: &Array, at: usize, action: &mut Array) {
        let params = low_level_input::Params {
            rows: self.rows as u32,
            observation: (observation.len() / self.rows) as u32,
            at: at as u32,
        };
        match &self.device {
            Device::Cpu => low_level_input::twin(
                observation.host(),
                latents.host(),
                self.widths.host(),
                self.input.host_mut(),
                &params,
            ),
            Device::Gpu(gpu) => low_level_input::launch(
                gpu,
                observation.buffer(),
                latents.buffer(),
                self.widths.buffer(),
                self.input.buffer(),
                &params,
            ),
        }
        let seen = match &self.normalizer {
            None => &self.input,
            Some(normalizer) => {
                normalizer.normalize(&self.input, 0, &mut self.normalized, 0, self.rows);
                &self.normalized
            }
        };
        self.engine
            .forward(0, &self.parameters, seen, 0, self.rows, action, 0);
    }

    /// Writes the style rewards `[rows]` of windows `[rows][2 style]`, under the latents that it acted by last.
    pub fn reward(&mut self, windows: &Array, reward: &mut Array) {
        let width = self.input.len() / self.rows;
        let latents = rows::columns(&self.device, &self.input, width, self.style..width);
        self.discriminator.reward(windows, &latents, reward);
    }
}
