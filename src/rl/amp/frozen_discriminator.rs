//! A discriminator that learns no more, on the host: what it takes a movement for.

use super::batch_discriminator::BatchDiscriminator;
use super::discriminator::network;
use super::{Amp, DiscriminatorLoss, LatentUse};
use crate::container::Section;
use crate::gpu::{Array, Device};
use crate::kernels::learn::{encoder_loss, style_reward};
use crate::nn::cpu::forward;
use crate::nn::{Engine, EngineSize, Network, RunningMeanStd};
use anyhow::Result;

/// A discriminator that learns no more.
#[derive(Clone)]
pub struct FrozenDiscriminator {
    network: Network,
    parameters: Vec<f32>,
    normalizer: RunningMeanStd,
    latents: LatentUse,
    params: style_reward::Params,
}

impl FrozenDiscriminator {
    /// Reads it from what a learner has saved; a window is two moments of `style` numbers each.
    ///
    /// # Errors
    /// The learner has none, or another.
    pub fn load(
        config: &Amp,
        latents: LatentUse,
        learner: &mut Section,
        style: usize,
    ) -> Result<Self> {
        let dim = 2 * style + latents.shown();
        let network = network(config, dim, latents)?;
        let mut own = learner.take_section("discriminator");
        Ok(FrozenDiscriminator {
            parameters: own.take_finite("discriminator.parameters", network.span().end)?,
            normalizer: RunningMeanStd::load(&mut own, dim)?,
            latents,
            params: style_reward::Params {
                samples: 1,
                outputs: network.outputs() as u32,
                heads: config.heads as u32,
                hinge: u32::from(config.loss == DiscriminatorLoss::Hinge),
            },
            network,
        })
    }

    /// What it has learned by.
    pub fn loss(&self) -> DiscriminatorLoss {
        match self.params.hinge {
            1 => DiscriminatorLoss::Hinge,
            _ => DiscriminatorLoss::Bce,
        }
    }

    /// The style reward of moving from a moment to the next under a latent, which counts where it is shown.
    pub fn reward(&self, moments: [&[f32]; 2], latent: &[f32]) -> f32 {
        self.reward_and_cosine(moments, latent).0
    }

    /// The style reward, and the cosine between the latent and what the encoder finds; `None` if there is no encoder.
    pub fn reward_and_cosine(&self, moments: [&[f32]; 2], latent: &[f32]) -> (f32, Option<f32>) {
        let output = self.output(moments, latent);
        let mut reward = [0.0];
        style_reward::twin(&output, &mut reward, &self.params);
        let found = &output[self.params.heads as usize..];
        let cosine = (!found.is_empty()).then(|| encoder_loss::cosine(found, latent).0);
        (reward[0], cosine)
    }

    fn output(&self, moments: [&[f32]; 2], latent: &[f32]) -> Vec<f32> {
        let shown = &latent[..self.latents.shown()];
        let mut window = Array::Host([moments[0], moments[1], shown].concat());
        self.normalizer.normalize_in_place(&mut window, 1);
        let mut output = vec![0.0; self.network.outputs()];
        forward(&self.network, &self.parameters, window.host(), &mut output);
        output
    }

    /// A copy on a device, for so many windows at once.
    ///
    /// # Errors
    /// The device has no room for it.
    pub fn on(&self, device: &Device, rows: usize) -> Result<BatchDiscriminator> {
        let size = EngineSize {
            parameters: self.parameters.len(),
            extras: 0,
            max_rows: rows,
            minibatch: 1,
        };
        Ok(BatchDiscriminator {
            engine: Engine::layerwise(device, vec![self.network.clone()], size)?,
            parameters: Array::from_slice(device, &self.parameters),
            normalizer: self.normalizer.on(device),
            latents: self.latents,
            outputs: Array::zeroed(device, rows * self.network.outputs()),
            params: style_reward::Params {
                samples: rows as u32,
                ..self.params
            },
            device: device.clone(),
        })
    }

    /// All that it has learned: the network's parameters, and the moments of its normaliser.
    pub fn learned(&self) -> [&[f32]; 2] {
        [&self.parameters, self.normalizer.moments()]
    }

    /// A reward from 0, an agent's without doubt, to 1, a recording's.
    pub fn share(&self, reward: f32) -> f32 {
        match self.params.hinge {
            1 => 0.5 + 0.5 * reward,
            _ => 1.0 - (-reward).exp(),
        }
    }
}
