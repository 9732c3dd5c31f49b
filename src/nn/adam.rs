//! Adam (Kingma and Ba 2015) on one flat vector, apart from what the gradient is of: it may be a sum over
//! machines.

use crate::container::{Section, SectionError};
use crate::gpu::{Array, Buffer, Device};
use crate::kernels::learn::{adam, adapt_lr, grad_norm};
use anyhow::Result;
use rayon::prelude::*;
use std::ops::Range;

/// Parameters that a core steps in one go.
const STRIP: usize = 1 << 14;

/// Running moments of the gradient, on a device.
pub struct Adam {
    /// Running mean of the gradient.
    pub m: Array,
    /// Running mean of its square.
    pub v: Array,
    /// Steps taken.
    pub steps: u64,
    device: Device,
    /// Factors of the learning rate: see [`adapt_lr`].
    rates: Array,
    /// Parameters whose learning rate has the second factor.
    second: Range<usize>,
    norm_partials: Array,
    /// Number of the parameters, for a shader's loops.
    count: Option<Buffer<u32>>,
}

impl Adam {
    /// Moments of a gradient that has been zero.
    pub fn new(device: &Device, parameters: usize) -> Self {
        let count = |gpu| Buffer::from_slice(gpu, &[parameters as u32]);
        Adam {
            m: Array::zeroed(device, parameters),
            v: Array::zeroed(device, parameters),
            rates: Array::from_slice(device, &[1.0, 1.0, 0.0]),
            second: 0..0,
            steps: 0,
            norm_partials: Array::zeroed(device, grad_norm::NORM_PARTIALS),
            count: match device {
                Device::Cpu => None,
                Device::Gpu(gpu) => Some(count(gpu)),
            },
            device: device.clone(),
        }
    }

    /// Lets the parameters of a range have a learning rate of their own, so many times that of the others.
    pub fn with_second_rate(mut self, second: Range<usize>, factor: f64) -> Self {
        self.second = second;
        self.rates = Array::from_slice(&self.device, &[1.0, factor as f32, 0.0]);
        self
    }

    /// Takes a step against `gradient`, which is first shortened to `max_grad_norm` where it is longer
    /// (0: it is not).
    pub fn step(
        &mut self,
        parameters: &mut Array,
        gradient: &Array,
        learning_rate: f64,
        max_grad_norm: f64,
    ) {
        self.steps += 1;
        let (len, second) = (self.m.len(), self.second.clone());
        let params = adam::Params::new(len, self.steps, learning_rate, max_grad_norm, second);
        match (&self.device, &self.count) {
            (Device::Gpu(gpu), Some(count)) => {
                let (gradient, norm) = (gradient.buffer(), self.norm_partials.buffer());
                grad_norm::launch(gpu, count, gradient, norm);
                let (m, v) = (self.m.buffer(), self.v.buffer());
                let (parameters, rates) = (parameters.buffer(), self.rates.buffer());
                adam::launch(gpu, gradient, norm, parameters, m, v, rates, &params);
            }
            _ => {
                let (gradient, norm) = (gradient.host(), self.norm_partials.host_mut());
                grad_norm::twin(gradient, norm);
                let parameters = parameters.host_mut().par_chunks_mut(STRIP);
                let strips = parameters.zip(gradient.par_chunks(STRIP));
                let moments = self.m.host_mut().par_chunks_mut(STRIP);
                let moments = moments.zip(self.v.host_mut().par_chunks_mut(STRIP));
                let rates = self.rates.host();
                strips.zip(moments).enumerate().for_each(
                    |(strip, ((parameters, gradient), (m, v)))| {
                        let params = params.of_strip(strip * STRIP, gradient.len());
                        adam::twin(gradient, norm, parameters, m, v, rates, &params);
                    },
                );
            }
        }
    }

    /// Adapts the first learning rate to the KL divergence that an objective's `sums` show.
    pub fn adapt(&mut self, sums: &mut Array, params: &adapt_lr::Params) {
        match &self.device {
            Device::Cpu => adapt_lr::twin(sums.host_mut(), self.rates.host_mut(), params),
            Device::Gpu(gpu) => {
                adapt_lr::launch(gpu, sums.buffer(), self.rates.buffer(), params);
            }
        }
    }

    /// The factor of the first learning rate.
    ///
    /// # Errors
    /// The device was lost.
    pub fn rate(&self) -> Result<f32> {
        Ok(self.rates.read(&self.device)?[0])
    }

    /// The norm of the last step's gradient, before it was shortened.
    ///
    /// # Errors
    /// The device was lost.
    pub fn grad_norm(&self) -> Result<f32> {
        let parts = self.norm_partials.read(&self.device)?;
        Ok(parts.iter().sum::<f32>().sqrt())
    }

    /// Saves moments and steps.
    ///
    /// # Errors
    /// The device was lost.
    pub fn save(&self, to: &mut Section) -> Result<()> {
        to.put("adam.steps", self.steps);
        to.put_array("adam.rates", &self.rates.read(&self.device)?);
        to.put_array("adam.m", &self.m.read(&self.device)?);
        to.put_array("adam.v", &self.v.read(&self.device)?);
        Ok(())
    }

    /// Puts back what [`Adam::save`] wrote.
    ///
    /// # Errors
    /// It is of another number of parameters, or not finite.
    pub fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        self.steps = from.get("adam.steps")?;
        let rates = from.take_finite("adam.rates", adapt_lr::RATES)?;
        self.rates = Array::from_slice(&self.device, &rates);
        for (name, moments) in [("adam.m", &mut self.m), ("adam.v", &mut self.v)] {
            let values = from.take_finite(name, moments.len())?;
            *moments = Array::from_slice(&self.device, &values);
        }
        Ok(())
    }
}
