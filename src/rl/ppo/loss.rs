//! PPO's objective (Schulman et al. 2017, equations 7 to 9) of an actor and a critic.

use super::Ppo;
use crate::gpu::{Array, Gpu};
use crate::kernels::learn::diversity_loss;
use crate::kernels::learn::ppo_loss::{self, Params};
use crate::nn::objective::{GpuBatch, HostBatch, Objective};
use std::ops::Range;

pub use crate::kernels::learn::ppo_loss::SUMS;

/// The choices that make up the loss of a minibatch. See [`Ppo`].
#[derive(Clone, Copy, Debug)]
pub struct LossCoefficients {
    /// Clip range of the probability ratio.
    pub clip: f32,
    /// Largest change of the critic's normalised output that is rewarded; 0 for no limit.
    pub value_clip: f32,
    /// Weight of the value loss.
    pub value_coefficient: f32,
    /// Weight of the entropy bonus.
    pub entropy_coefficient: f32,
    /// Weight of the penalty on the KL divergence, as it is adapted by now.
    pub kl_coefficient: f32,
    /// 1 where standard deviations are learned, 0 where they stay.
    pub std_coefficient: f32,
    /// 1 / samples of the mean.
    pub inv_count: f32,
}

impl LossCoefficients {
    /// Those of a sum over samples, at the present weight of the KL penalty.
    pub fn new(config: &Ppo, kl_coefficient: f64) -> Self {
        LossCoefficients {
            clip: config.clip as f32,
            value_clip: config.value_clip as f32,
            value_coefficient: config.value_coefficient as f32,
            entropy_coefficient: config.entropy_coefficient as f32,
            kl_coefficient: kl_coefficient as f32,
            std_coefficient: if config.fixed_std { 0.0 } else { 1.0 },
            inv_count: 1.0,
        }
    }
}

/// PPO's loss of samples whose numbers are observation, action, old mean, old log probability, advantage,
/// targets, old values. The actor is network 0, the critic network 1.
pub struct PpoLoss<'a> {
    /// Numbers of an action.
    pub action: usize,
    /// Numbers of the critic's output: a value of each stream of rewards.
    pub values: usize,
    /// Indices of the logarithms of the standard deviations in the flat vector, behind the networks.
    pub log_std: Range<usize>,
    /// `[action]`, as they were when the policy acted.
    pub old_log_std: &'a Array,
    /// Weights and clip ranges of the loss.
    pub coefficients: LossCoefficients,
    /// What latents are to lead to.
    pub diversity: Diversity,
}

/// The loss of latents that lead to the same actions: see [`diversity_loss`]. A sample then ends with the mean
/// action under another latent, the agent's own latent, and that other one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Diversity {
    /// Numbers of a latent, the last of an observation.
    pub latent: usize,
    /// Weight of the loss; 0 for none.
    pub weight: f32,
}

impl Diversity {
    /// Numbers that a sample ends with.
    pub fn width(&self, action: usize) -> usize {
        match self.weight > 0.0 && self.latent > 0 {
            true => action + 2 * self.latent,
            false => 0,
        }
    }
}

impl PpoLoss<'_> {
    fn params(&self) -> Params {
        let coefficients = &self.coefficients;
        Params {
            rows: 0,
            start: 0,
            width: 0,
            clip: coefficients.clip,
            value_clip: coefficients.value_clip,
            value_coefficient: coefficients.value_coefficient,
            entropy_coefficient: coefficients.entropy_coefficient,
            kl_coefficient: coefficients.kl_coefficient,
            std_coefficient: coefficients.std_coefficient,
            inv_count: coefficients.inv_count,
        }
    }

    fn diversity_params(&self) -> diversity_loss::Params {
        diversity_loss::Params {
            rows: 0,
            start: 0,
            width: 0,
            latent: self.diversity.latent as u32,
            weight: self.diversity.weight * self.coefficients.inv_count,
        }
    }

    /// Where a sample ends for PPO.
    fn own<'a>(&self, row: &&'a [f32]) -> &'a [f32] {
        &row[..row.len() - self.diversity.width(self.action)]
    }
}

impl Objective for PpoLoss<'_> {
    fn loss_gradient(&self, batch: &HostBatch, outputs: &mut [f32], extras: &mut [f32]) {
        let params = self.params();
        let diverse = self.diversity.width(self.action) > 0;
        let own: Vec<&[f32]> = batch.rows.iter().map(|row| self.own(row)).collect();
        match batch.network {
            0 => {
                let more = diverse.then(|| {
                    let params = self.diversity_params();
                    diversity_loss::gradients(batch.rows, outputs, &params)
                });
                let log_std = &batch.parameters[self.log_std.clone()];
                let old_log_std = self.old_log_std.host();
                ppo_loss::actor(
                    log_std,
                    old_log_std,
                    &own,
                    outputs,
                    extras,
                    self.values,
                    &params,
                );
                let more = more.unwrap_or_default();
                let pairs = outputs.iter_mut().zip(more);
                pairs.for_each(|(gradient, more)| *gradient += more);
            }
            _ => ppo_loss::critic(&own, outputs, extras, self.values, &params),
        }
    }

    fn launch(&self, gpu: &Gpu, batch: &GpuBatch) {
        let params = Params {
            rows: batch.rows as u32,
            start: batch.first as u32,
            width: batch.width as u32,
            ..self.params()
        };
        ppo_loss::launch(
            gpu,
            batch.dims,
            batch.samples,
            batch.parameters,
            self.old_log_std.buffer(),
            batch.outputs,
            batch.output_grads,
            batch.extras,
            &params,
        );
        if self.diversity.width(self.action) > 0 {
            let params = diversity_loss::Params {
                rows: params.rows,
                start: params.start,
                width: params.width,
                ..self.diversity_params()
            };
            diversity_loss::launch(
                gpu,
                batch.dims,
                batch.samples,
                batch.outputs,
                batch.output_grads,
                &params,
            );
        }
    }
}
