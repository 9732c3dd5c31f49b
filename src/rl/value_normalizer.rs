//! Keeps the critic's targets near zero mean and unit standard deviation: a reward of +1000 would
//! drown it otherwise (as PopArt does, but without rescaling the last layer).

use super::rollout::Rollout;
use crate::container::{Section, SectionError};
use crate::gpu::{Array, Device};
use crate::kernels::learn::rollout_moments::{Params, launch, scale, twin};
use anyhow::Result;

/// Weight of the newest rollout in the running moments.
const NEWEST: f32 = 0.1;

/// Running mean and mean square of the returns, in units of reward.
pub struct ValueNormalizer {
    device: Device,
    /// `[mean, mean square]`
    moments: Array,
    /// See [`scale`]: what normalises the samples of the present rollout.
    scale: Array,
    updates: u64,
}

impl ValueNormalizer {
    /// Mean 0, standard deviation 1.
    pub fn new(device: &Device) -> Self {
        let mut values = [0.0; scale::FIELDS];
        values[scale::OLD_STD] = 1.0;
        ValueNormalizer {
            device: device.clone(),
            moments: Array::from_slice(device, &[0.0, 1.0]),
            scale: Array::from_slice(device, &values),
            updates: 0,
        }
    }

    /// `[scale::FIELDS]`
    pub fn scale(&self) -> &Array {
        &self.scale
    }

    /// Takes the returns of rollouts in. The first ones count in full, so that the moments start
    /// right. Afterwards the scale holds what normalises their samples.
    pub fn update(&mut self, rollouts: &[Rollout]) {
        self.updates += 1;
        let params = Params {
            samples: rollouts.iter().map(|part| part.samples() as u32).sum(),
            weight: NEWEST.max(1.0 / self.updates as f32),
        };
        match &self.device {
            Device::Cpu => twin(
                &joined(rollouts, |part| &part.log_prob_and_value),
                &joined(rollouts, |part| &part.advantage_and_return),
                self.moments.host_mut(),
                self.scale.host_mut(),
                &params,
            ),
            Device::Gpu(gpu) => launch(
                gpu,
                rollouts[0].log_prob_and_value.buffer(),
                rollouts[0].advantage_and_return.buffer(),
                self.moments.buffer(),
                self.scale.buffer(),
                &params,
            ),
        }
    }

    /// Lets values from now on be in the newest scale.
    ///
    /// # Errors
    /// The device was lost.
    pub fn advance(&mut self) -> Result<[f32; scale::FIELDS]> {
        let mut values: [f32; scale::FIELDS] = [0.0; scale::FIELDS];
        values.copy_from_slice(&self.scale.read(&self.device)?);
        let old = values;
        values[scale::OLD_MEAN] = values[scale::NEW_MEAN];
        values[scale::OLD_STD] = values[scale::NEW_STD];
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
        let moments = from.take_finite("value_moments", 2)?;
        let values = from.take_finite("value_scale", scale::FIELDS)?;
        self.moments = Array::from_slice(&self.device, &moments);
        self.scale = Array::from_slice(&self.device, &values);
        Ok(())
    }
}

/// `[2][samples]` of all parts, from those of each.
fn joined(rollouts: &[Rollout], of: fn(&Rollout) -> &Array) -> Vec<f32> {
    let half = |number: usize| {
        let halves = rollouts.iter().map(move |part| {
            let samples = part.samples();
            &of(part).host()[number * samples..][..samples]
        });
        halves.flatten().copied()
    };
    half(0).chain(half(1)).collect()
}
