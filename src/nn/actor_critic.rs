//! The parameters of an actor and a critic in one flat vector.

use super::layer::Activation;
use super::network::{Network, NetworkConfig, NetworkError};
use super::observation::ObservationSpec;
use crate::kernels::rng::{gaussian, random4};
use std::ops::Range;

/// Two separate networks of the same hidden layers. The actor's parameters come first, then the critic's,
/// then the logarithms of the standard deviations of the actions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ActorCritic {
    /// Observations to mean actions.
    pub actor: Network,
    /// Observations to a value of each stream of rewards.
    pub critic: Network,
}

impl ActorCritic {
    /// Networks for actions of `action` numbers and so many `values`.
    ///
    /// # Errors
    /// There can be no such networks, or not for such observations.
    pub fn new(
        config: &NetworkConfig,
        observation: &ObservationSpec,
        action: usize,
        values: usize,
    ) -> Result<Self, NetworkError> {
        let actor = Network::new(config, observation, action, 0)?;
        let critic = Network::new(config, observation, values, actor.span().end)?;
        Ok(ActorCritic { actor, critic })
    }

    /// Both networks: the actor is number 0, the critic 1.
    pub fn networks(&self) -> Vec<Network> {
        vec![self.actor.clone(), self.critic.clone()]
    }

    /// Indices of the logarithms of the standard deviations.
    pub fn log_std(&self) -> Range<usize> {
        let start = self.critic.span().end;
        start..start + self.actor.outputs()
    }

    /// Length of the flat vector.
    pub fn parameters(&self) -> usize {
        self.log_std().end
    }

    /// Gaussian weights of unit gain, nearly none in the last layers, so that learning starts from the
    /// plain distribution and the mean value (as RLlib's networks do); zero biases, but for those of the
    /// actor's last layer, if `bias` is not empty: mean actions then start near it.
    pub fn init(&self, seed: u32, log_std: f32, bias: &[f32]) -> Vec<f32> {
        const STREAM: u32 = 0x494e_4954;
        const LAST_GAIN: f32 = 0.01;
        let mut flat = vec![0.0; self.parameters()];
        for network in [&self.actor, &self.critic] {
            for params in network.layers() {
                let gain = match params.layer.activation() {
                    // ReLU halves what passes; tanh leaves it.
                    Activation::Relu => 2f32.sqrt(),
                    Activation::Tanh => 1.0,
                    Activation::Identity => LAST_GAIN,
                };
                let deviation = gain / (params.layer.patch() as f32).sqrt();
                for at in params.weights() {
                    flat[at] = deviation * gaussian(random4(seed, at as u32, 0, STREAM));
                }
            }
        }
        let biases = self.actor.span().end - bias.len()..self.actor.span().end;
        flat[biases].copy_from_slice(bias);
        flat[self.log_std()].fill(log_std);
        flat
    }
}
