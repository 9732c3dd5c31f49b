//! Keeps the critic's targets near zero mean and unit standard deviation: a reward of +1000 would
//! drown it otherwise (as PopArt does, but without rescaling the last layer).

use super::rollout::Rollout;
use crate::container::{Section, SectionError};
use crate::gpu::{Array, Device};
use crate::kernels::learn::normalize_advantages;
use crate::kernels::learn::rollout_moments::{Params, launch, scale, twin};
use crate::nn::rows;
use anyhow::Result;

/// Weight of the newest rollout in the running moments.
const NEWEST: f32 = 0.1;

/// Running mean and mean square of the returns of each stream of rewards, in units of reward.
pub struct ValueNormalizer {
    device: Device,
    streams: usize,
    /// `[streams][mean, mean square]`
    moments: Array,
    /// `[streams][FIELDS]`, see [`scale`]: what normalises the samples of the present rollout.
    scale: Array,
    updates: u64,
}

impl ValueNormalizer {
    /// Mean 0, standard deviation 1 of each stream, whose advantages have these `weights`.
    pub fn new(device: &Device, weights: &[f32]) -> Self {
        let mut values = vec![0.0; weights.len() * scale::FIELDS];
        for (values, &weight) in values.chunks_exact_mut(scale::FIELDS).zip(weights) {
            values[scale::OLD_STD] = 1.0;
            values[scale::WEIGHT] = weight;
        }
        ValueNormalizer {
            device: device.clone(),
            streams: weights.len(),
            moments: Array::from_slice(device, &[0.0, 1.0].repeat(weights.len())),
            scale: Array::from_slice(device, &values),
            updates: 0,
        }
    }

    /// `[streams][FIELDS]`
    pub fn scale(&self) -> &Array {
        &self.scale
    }

    /// Changes the weight of a stream's advantages.
    pub fn set_weight(&mut self, stream: usize, weight: f32) {
        let at = stream * scale::FIELDS + scale::WEIGHT;
        let weight = Array::from_slice(&self.device, &[weight]);
        rows::replace(&self.device, &mut self.scale, at, &weight);
    }

    /// Takes the returns of rollouts in. The first ones count in full, so that the moments start
    /// right. Afterwards the scale holds what normalises their samples.
    pub fn update(&mut self, rollouts: &[Rollout]) {
        self.updates += 1;
        let params = |stream: usize| Params {
            samples: rollouts.iter().map(|part| part.samples() as u32).sum(),
            weight: NEWEST.max(1.0 / self.updates as f32),
            streams: self.streams as u32,
            stream: stream as u32,
        };
        match &self.device {
            Device::Cpu => {
                let values = joined(rollouts, |part| &part.log_prob_and_value, 1);
                let returns = joined(rollouts, |part| &part.advantage_and_return, self.streams);
                let groups: Vec<&[u32]> = rollouts.iter().map(|part| part.group.host()).collect();
                let groups = groups.concat();
                for stream in 0..self.streams {
                    let params = params(stream);
                    let (moments, scale) = (self.moments.host_mut(), self.scale.host_mut());
                    twin(&values, &returns, &groups, moments, scale, &params);
                }
            }
            Device::Gpu(gpu) => {
                for stream in 0..self.streams {
                    launch(
                        gpu,
                        rollouts[0].log_prob_and_value.buffer(),
                        rollouts[0].advantage_and_return.buffer(),
                        rollouts[0].group.buffer(),
                        self.moments.buffer(),
                        self.scale.buffer(),
                        &params(stream),
                    );
                }
            }
        }
    }

    /// Normalises the advantages of rollouts that have been taken in, each group's apart, and weighs them.
    pub fn normalize_advantages(&self, rollouts: &mut [Rollout]) {
        for rollout in rollouts {
            let params = normalize_advantages::Params {
                samples: rollout.samples() as u32,
                streams: self.streams as u32,
            };
            match &self.device {
                Device::Cpu => normalize_advantages::twin(
                    rollout.group.host(),
                    self.scale.host(),
                    rollout.advantage_and_return.host_mut(),
                    &params,
                ),
                Device::Gpu(gpu) => normalize_advantages::launch(
                    gpu,
                    rollout.group.buffer(),
                    self.scale.buffer(),
                    rollout.advantage_and_return.buffer(),
                    &params,
                ),
            }
        }
    }

    /// Lets values from now on be in the newest scale. Returns the scale before, `[streams][FIELDS]`.
    ///
    /// # Errors
    /// The device was lost.
    pub fn advance(&mut self) -> Result<Vec<f32>> {
        let mut values = self.scale.read(&self.device)?;
        let old = values.clone();
        for values in values.chunks_exact_mut(scale::FIELDS) {
            values[scale::OLD_MEAN] = values[scale::NEW_MEAN];
            values[scale::OLD_STD] = values[scale::NEW_STD];
        }
        self.scale = Array::from_slice(&self.device, &values);
        Ok(old)
    }

    /// Saves the moments.
    ///
    /// # Errors
    /// The device was lost.
    pub fn save(&self, to: &mut Section) -> Result<()> {
        to.put("value_updates", self.updates);
        to.put_array("value_moments", &self.moments.read(&self.device)?);
        to.put_array("value_scale", &self.scale.read(&self.device)?);
        Ok(())
    }

    /// Puts saved moments back.
    ///
    /// # Errors
    /// They are missing or damaged.
    pub fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        self.updates = from.get("value_updates")?;
        let moments = from.take_finite("value_moments", self.moments.len())?;
        let values = from.take_finite("value_scale", self.scale.len())?;
        self.moments = Array::from_slice(&self.device, &moments);
        self.scale = Array::from_slice(&self.device, &values);
        Ok(())
    }
}

/// Two columns, of which the first has `width` numbers a sample, of all parts, from those of each.
fn joined(rollouts: &[Rollout], of: fn(&Rollout) -> &Array, width: usize) -> Vec<f32> {
    let halves = rollouts
        .iter()
        .map(|part| of(part).host().split_at(width * part.samples()));
    let (first, second): (Vec<&[f32]>, Vec<&[f32]>) = halves.unzip();
    [first.concat(), second.concat()].concat()
}
