//! Adam (Kingma and Ba 2015) on one flat vector. burn-optim's clips each tensor's gradient by
//! itself and keys its state by random names; one vector makes the norm of the whole gradient a
//! single operation on the device and the state two plain arrays of a checkpoint.

use crate::kernels::learn::adam::{self, BETA_1, BETA_2, EPSILON};
use super::tensors::sum;
use burn::tensor::{Device, Tensor};
use multiversion::multiversion;

/// Moments of the gradient.
#[derive(Clone)]
pub struct Adam {
    pub first: Tensor<1>,
    pub second: Tensor<1>,
    /// Steps taken.
    pub steps: u64,
}

impl Adam {
    pub fn new(parameters: usize, device: &Device) -> Self {
        let zeros = Tensor::zeros([parameters], device);
        Adam {
            first: zeros.clone(),
            second: zeros,
            steps: 0,
        }
    }

    /// Parameters after one step against `gradient`, whose norm is first cut to `max_norm` (0: not).
    pub fn step(
        &mut self,
        parameters: Tensor<1>,
        gradient: Tensor<1>,
        rate: f64,
        max_norm: f64,
    ) -> Tensor<1> {
        let gradient = if max_norm > 0.0 {
            clip(gradient, max_norm)
        } else {
            gradient
        };
        self.steps += 1;
        let [rate, unbias] = unbiased(self.steps, rate);
        self.first = self
            .first
            .clone()
            .mul_scalar(BETA_1)
            .add(gradient.clone().mul_scalar(1.0 - BETA_1));
        self.second = self
            .second
            .clone()
            .mul_scalar(BETA_2)
            .add(gradient.square().mul_scalar(1.0 - BETA_2));
        let first = self.first.clone().mul_scalar(rate);
        let second = self.second.clone().mul_scalar(unbias);
        parameters.sub(first.div(second.sqrt().add_scalar(EPSILON)))
    }

    /// What the next step is launched with.
    pub(super) fn next(&mut self, parameters: usize, rate: f64, max_norm: f64) -> adam::Params {
        self.steps += 1;
        let [rate, unbias] = unbiased(self.steps, rate).map(|factor| factor as f32);
        adam::Params {
            parameters: parameters as u32,
            rate,
            unbias,
            max_norm: max_norm as f32,
        }
    }
}

/// Learning rate and factor of the second moment that make up for moments that began at zero.
fn unbiased(steps: u64, rate: f64) -> [f64; 2] {
    let steps = steps.min(i32::MAX as u64) as i32;
    [
        rate / (1.0 - BETA_1.powi(steps)),
        1.0 / (1.0 - BETA_2.powi(steps)),
    ]
}

fn clip(gradient: Tensor<1>, max_norm: f64) -> Tensor<1> {
    let norm = sum(gradient.clone().square()).sqrt();
    gradient.mul(
        norm.add_scalar(1e-6)
            .recip()
            .mul_scalar(max_norm)
            .clamp_max(1.0),
    )
}

/// [`Adam::step`] on the CPU: the `steps`-th.
#[multiversion(targets("x86_64+avx512f+avx512vl+fma", "x86_64+avx2+fma", "aarch64+neon"))]
pub fn step(
    parameters: &mut [f32],
    gradient: &[f32],
    first: &mut [f32],
    second: &mut [f32],
    steps: u64,
    rate: f64,
    max_norm: f64,
) {
    // Several sums at once, so that they need not wait for each other.
    let mut squares = [0f64; 16];
    for (i, gradient) in gradient.iter().enumerate() {
        squares[i % 16] += f64::from(*gradient) * f64::from(*gradient);
    }
    let norm = squares.iter().sum::<f64>().sqrt();
    let cut = match max_norm > 0.0 {
        true => (max_norm / (norm + 1e-6)).min(1.0) as f32,
        false => 1.0,
    };
    let [keep_1, keep_2] = [BETA_1, BETA_2].map(|beta| beta as f32);
    let [take_1, take_2] = [BETA_1, BETA_2].map(|beta| (1.0 - beta) as f32);
    let [rate, unbias] = unbiased(steps, rate).map(|factor| factor as f32);
    let moments = first.iter_mut().zip(second.iter_mut());
    for ((parameter, gradient), (first, second)) in parameters.iter_mut().zip(gradient).zip(moments)
    {
        let gradient = gradient * cut;
        *first = keep_1 * *first + take_1 * gradient;
        *second = keep_2 * *second + take_2 * gradient * gradient;
        *parameter -= rate * *first / ((*second * unbias).sqrt() + EPSILON as f32);
    }
}
