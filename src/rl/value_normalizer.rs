//! Keeps the critic's targets near zero mean and unit deviation (the +1000 of arriving would
//! drown it otherwise). Lives on the device: a tensor of two numbers.

use crate::nn::tensors::mean;
use burn::tensor::{Device, Tensor};

/// Share of the newest rollout in the running statistics.
const NEWEST: f64 = 0.1;
const LEAST_DEVIATION: f64 = 1e-3;

/// Running mean and second moment of the targets, in units of reward.
#[derive(Clone)]
pub struct Scale {
    /// `[mean, mean square]`.
    pub moments: Tensor<1>,
    pub updates: u64,
}

impl Scale {
    /// Mean 0, deviation 1.
    pub fn new(device: &Device) -> Self {
        Scale {
            moments: Tensor::from_floats([0.0, 1.0], device),
            updates: 0,
        }
    }

    /// `[mean, deviation]`.
    pub fn mean_and_deviation(&self) -> Tensor<1> {
        let mean = self.moments.clone().narrow(0, 0, 1);
        let square = self.moments.clone().narrow(0, 1, 1);
        let deviation = square
            .sub(mean.clone().square())
            .clamp_min(LEAST_DEVIATION * LEAST_DEVIATION)
            .sqrt();
        Tensor::cat(vec![mean, deviation], 0)
    }

    /// Takes a rollout's targets in and returns them normalised. The first rollouts count in
    /// full, so that the statistics start right.
    pub fn update(&mut self, targets: Tensor<1>) -> Tensor<1> {
        self.updates += 1;
        let share = NEWEST.max(1.0 / self.updates as f64);
        let newest = Tensor::cat(
            vec![mean(targets.clone()), mean(targets.clone().square())],
            0,
        );
        self.moments = self
            .moments
            .clone()
            .mul_scalar(1.0 - share)
            .add(newest.mul_scalar(share));
        let scale = self.mean_and_deviation();
        targets
            .sub(scale.clone().narrow(0, 0, 1))
            .div(scale.narrow(0, 1, 1))
    }
}
