//! Policies that learn no more, on a device, each of whom acts for rows of its own.

use crate::gpu::{Array, Device};
use crate::kernels::self_play::opponent_input;
use crate::nn::running_mean_std::CLIP;
use crate::nn::{Network, NetworkCopies, Policy};
use anyhow::{Result, bail};

/// Policies of one form on a device: their actors are evaluated together.
pub(super) struct FrozenPolicies {
    device: Device,
    copies: NetworkCopies,
    /// `[policies][parameters]`: of an actor, then logarithms of standard deviations.
    pub parameters: Array,
    /// Index of these among the parameters of a policy, and how many parameters there are.
    pub log_std: usize,
    pub parameters_each: usize,
    /// `[policies][2][observation]`, see [`opponent_input`].
    scale: Array,
    clip: f32,
    /// `[slots][observation]`, and mean actions `[slots][action]`.
    input: Array,
    pub mean: Array,
}

impl FrozenPolicies {
    /// A copy of `policies`, who are not none, on a device, for so many rows.
    ///
    /// # Errors
    /// They are not of one form, or the device has no room for them.
    pub fn new(policies: &[&Policy], device: &Device, slots: usize) -> Result<Self> {
        let first = policies[0];
        if !policies.iter().all(|policy| policy.has_form_of(first)) {
            bail!("opponents are policies of one form");
        }
        let actor: Network = first.networks().actor.clone();
        let own = |policy: &&Policy| [&policy.parameters[actor.span()], policy.log_std()].concat();
        let parameters: Vec<f32> = policies.iter().flat_map(own).collect();
        let (observation, parameters_each) =
            (first.observation().dim(), parameters.len() / policies.len());
        device.holds("opponents", parameters.len())?;
        device.holds("observations of opponents", slots * observation)?;
        let unscaled = [vec![0.0; observation], vec![1.0; observation]].concat();
        let scale = |policy: &&Policy| match &policy.normalizer {
            Some(normalizer) => [normalizer.mean(), &normalizer.inv_std()].concat(),
            None => unscaled.clone(),
        };
        let scale: Vec<f32> = policies.iter().flat_map(scale).collect();
        Ok(FrozenPolicies {
            parameters: Array::from_slice(device, &parameters),
            log_std: actor.span().len(),
            parameters_each,
            scale: Array::from_slice(device, &scale),
            clip: first.normalizer.as_ref().map_or(f32::MAX, |_| CLIP),
            input: Array::zeroed(device, slots * observation),
            mean: Array::zeroed(device, slots * first.action()),
            copies: NetworkCopies::new(device, actor, parameters_each, slots)?,
            device: device.clone(),
        })
    }

    /// Evaluates the policies in the environments of their `slots`, whose agents observe `[2 envs][observation]`, the
    /// learner's in the rows `own`. Every block of slots is of one policy: see [`opponent_input`].
    pub fn evaluate(
        &mut self,
        slots: &Array<u32>,
        blocks: &Array<u32>,
        own: &Array<u32>,
        observation: &Array,
    ) {
        let params = opponent_input::Params {
            slots: slots.len() as u32,
            observation: (self.input.len() / slots.len()) as u32,
            block: (slots.len() / blocks.len()) as u32,
            clip: self.clip,
        };
        match &self.device {
            Device::Cpu => opponent_input::twin(
                slots.host(),
                blocks.host(),
                own.host(),
                observation.host(),
                self.scale.host(),
                self.input.host_mut(),
                &params,
            ),
            Device::Gpu(gpu) => opponent_input::launch(
                gpu,
                slots.buffer(),
                blocks.buffer(),
                own.buffer(),
                observation.buffer(),
                self.scale.buffer(),
                self.input.buffer(),
                &params,
            ),
        }
        let (parameters, mean) = (&self.parameters, &mut self.mean);
        self.copies.forward(parameters, blocks, &self.input, mean);
    }
}
