//! Keeps the critic's targets near zero mean and unit standard deviation: a reward of +1000 would
//! drown it otherwise (as PopArt does, but without rescaling the last layer).

use super::rollout::Rollout;
use crate::container::{Section, SectionError};
use crate::gpu::{Array, Device};
use crate::kernels::learn::normalize_advantages;
use crate::kernels::learn::rollout_moments::{Params, launch, over_ranks, scale};
use crate::nn::rows;
use crate::ranks::Ranks;
use anyhow::Result;

/// Weight of the newest rollout in the running moments.
const NEWEST: f32 = 0.1;

/// Running mean and mean square of the returns of each stream of rewards, in units of reward.
pub struct ValueNormalizer {
    device: Device,
    ranks: Ranks,
    streams: usize,
    /// `[streams][mean, mean square]`
    moments: Array,
    /// `[streams][FIELDS]`, see [`scale`]: what normalises the samples of the present rollout.
    scale: Array,
    updates: u64,
}

impl ValueNormalizer {
    /// Mean 0, standard deviation 1 of each stream, whose advantages have these `weights`.
    pub fn new(device: &Device, ranks: &Ranks, weights: &[f32]) -> Self {
        let mut values = vec![0.0; weights.len() * scale::FIELDS];
        for (values, &weight) in values.chunks_exact_mut(scale::FIELDS).zip(weights) {
            values[scale::OLD_STD] = 1.0;
            values[scale::WEIGHT] = weight;
        }
        ValueNormalizer {
            device: device.clone(),
            ranks: ranks.clone(),
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

    /// Takes the returns of rollouts in, those of all ranks. The first ones count in full, so that the moments start
    /// right. Afterwards the scale holds what normalises their samples.
    ///
    /// # Errors
    /// The device was lost.
    pub fn update(&mut self, rollouts: &[Rollout]) -> Result<()> {
        self.updates += 1;
        let params = |stream: usize| Params {
            samples: rollouts.iter().map(|part| part.samples() as u32).sum(),
            weight: NEWEST.max(1.0 / self.updates as f32),
            streams: self.streams as u32,
            stream: stream as u32,
        };
        match &self.device {
            Device::Gpu(gpu) if self.ranks.is_alone() => {
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
            device => {
                let values = joined(device, rollouts, |part| &part.log_prob_and_value, 1)?;
                let streams = self.streams;
                let returns = joined(device, rollouts, |part| &part.advantage_and_return, streams)?;
                let groups = rollouts.iter().map(|part| part.group.read(device));
                let groups = groups.collect::<Result<Vec<_>>>()?.concat();
                let mut moments = self.moments.read(device)?;
                let mut scale = self.scale.read(device)?;
                for stream in 0..streams {
                    over_ranks(
                        [&values, &returns],
                        &groups,
                        &mut moments,
                        &mut scale,
                        &params(stream),
                        |sums| together(&self.ranks, sums),
                    );
                }
                self.moments = Array::from_slice(device, &moments);
                self.scale = Array::from_slice(device, &scale);
            }
        }
        Ok(())
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

/// Sums over the ranks, where there are several; they are told as floats of 32 bits.
fn together(ranks: &Ranks, sums: &mut [f64]) {
    if ranks.is_alone() {
        return;
    }
    let mut told: Vec<f32> = sums.iter().map(|&sum| sum as f32).collect();
    ranks.sum(&mut told);
    for (sum, told) in sums.iter_mut().zip(told) {
        *sum = told.into();
    }
}

/// Two columns, of which the first has `width` numbers a sample, of all parts, from those of each.
fn joined(
    device: &Device,
    rollouts: &[Rollout],
    of: fn(&Rollout) -> &Array,
    width: usize,
) -> Result<Vec<f32>> {
    let (mut first, mut second) = (Vec::new(), Vec::new());
    for part in rollouts {
        let mut both = of(part).read(device)?;
        second.push(both.split_off(width * part.samples()));
        first.push(both);
    }
    Ok([first.concat(), second.concat()].concat())
}
