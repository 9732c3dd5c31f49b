//! A discriminator that learns no more, on the host: what it takes a movement for.

use super::discriminator::network;
use super::{Amp, DiscriminatorLoss};
use crate::container::Section;
use crate::gpu::Array;
use crate::kernels::learn::style_reward;
use crate::nn::cpu::forward;
use crate::nn::{Network, RunningMeanStd};
use anyhow::Result;

/// A discriminator that learns no more.
pub struct FrozenDiscriminator {
    network: Network,
    parameters: Vec<f32>,
    normalizer: RunningMeanStd,
    params: style_reward::Params,
}

impl FrozenDiscriminator {
    /// Reads it from what a learner has saved; a window is two moments of `style` numbers each.
    ///
    /// # Errors
    /// The learner has none, or another.
    pub fn load(config: &Amp, learner: &mut Section, style: usize) -> Result<Self> {
        let network = network(config, 2 * style)?;
        let mut own = learner.take_section("discriminator");
        Ok(FrozenDiscriminator {
            parameters: own.take_finite("discriminator.parameters", network.span().end)?,
            normalizer: RunningMeanStd::load(&mut own, 2 * style)?,
            params: style_reward::Params {
                samples: 1,
                heads: config.heads as u32,
                hinge: u32::from(config.loss == DiscriminatorLoss::Hinge),
            },
            network,
        })
    }

    /// The style reward of moving from a moment to the next.
    pub fn reward(&self, moments: [&[f32]; 2]) -> f32 {
        let mut window = Array::Host(moments.concat());
        self.normalizer.normalize_in_place(&mut window, 1);
        let mut output = vec![0.0; self.network.outputs()];
        forward(&self.network, &self.parameters, window.host(), &mut output);
        let mut reward = [0.0];
        style_reward::twin(&output, &mut reward, &self.params);
        reward[0]
    }

    /// A reward from 0, an agent's without doubt, to 1, a recording's.
    pub fn share(&self, reward: f32) -> f32 {
        match self.params.hinge {
            1 => 0.5 + 0.5 * reward,
            _ => 1.0 - (-reward).exp(),
        }
    }
}
