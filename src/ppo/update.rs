//! Improves policy and critic on one rollout.

use super::Ppo;
use super::adam::Adam;
use super::network::Shape;
use super::policy::Policy;
use super::rollout::Rollout;
use super::scale::Scale;
use crate::kernels::rng::permutation;
use crate::motion::features::TRAJECTORY;
use crate::tensors::vector;
use anyhow::Context;
use burn::tensor::{Device, Int, Tensor, TensorData};
use rayon::prelude::*;

/// Everything that learns, on one device.
pub struct Learner {
    pub shape: Shape,
    pub parameters: Tensor<1>,
    pub adam: Adam,
    pub scale: Scale,
    pub learning_rate: f64,
    /// Weight of the KL penalty, if there is one.
    pub kl_coefficient: f64,
    pub updates: u64,
    seed: u32,
    /// Pieces a minibatch is cut into, learned from side by side.
    shards: usize,
}

/// Means over the last pass of an update.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Losses {
    pub policy: f32,
    pub value: f32,
    pub entropy: f32,
    /// Of the old policy from the new one, exact for Gaussians.
    pub kl: f32,
    /// Share of samples whose probability ratio left the clip range.
    pub clip_fraction: f32,
    /// 1 - variance of the critic's error / variance of its target, before the update.
    pub explained_variance: f32,
}

impl Losses {
    /// From the first six numbers of what [`Learner::update`] leaves on the device.
    pub fn from(numbers: &[f32]) -> Self {
        Losses {
            policy: numbers[0],
            value: numbers[1],
            entropy: numbers[2],
            kl: numbers[3],
            clip_fraction: numbers[4],
            explained_variance: numbers[5],
        }
    }
}

/// Columns of a packed sample, so that shuffling is one gather: observation, action, mean and
/// [`SCALARS`].
const SCALARS: usize = 4;
/// First random stream of the shuffles.
const SHUFFLE: u32 = 0x5348_5546;
const HALF_LOG_TAU: f64 = 0.918_938_533_204_672_7;

impl Learner {
    /// Learns from observations of `width` numbers.
    ///
    /// # Errors
    /// A filter of the network does not fit the maps.
    pub fn new(config: &Ppo, width: usize, device: &Device, seed: u32) -> anyhow::Result<Self> {
        let shape = Shape::new(&config.network, width)
            .context("a filter of ppo.network.convolutions is larger than what it sees")?;
        let parameters = vector(&shape.init(seed, config.log_std), device);
        Ok(Learner {
            adam: Adam::new(shape.parameters(), device),
            scale: Scale::new(device),
            shape,
            parameters,
            learning_rate: config.learning_rate,
            kl_coefficient: config.kl_coefficient,
            updates: 0,
            seed,
            // Flex runs one tensor operation on one core: two pieces occupy two of them. The number
            // is fixed, so that results do not depend on the machine's cores.
            shards: if *device == Device::flex() { 2 } else { 1 },
        })
    }

    pub fn policy(&self) -> Policy {
        self.shape.cut(&self.parameters)
    }

    /// One update. Returns `[policy, value, entropy, kl, clip fraction, explained variance]` on the
    /// device, so that nothing waits for it here.
    pub fn update(&mut self, rollout: &Rollout, config: &Ppo) -> Tensor<1> {
        let samples = rollout.value.dims()[0];
        let explained = explained_variance(&rollout.target, &rollout.value, &self.scale);
        let batch = self.pack(rollout);
        let device = self.parameters.device();
        let mut sums = Vec::new();
        for epoch in 0..config.epochs {
            let stream = SHUFFLE + epoch as u32;
            let order = permutation(self.seed, self.updates as u32, stream, samples);
            let order = order.into_iter().map(|i| i as i32).collect::<Vec<_>>();
            let order = Tensor::<1, Int>::from_data(TensorData::new(order, [samples]), &device);
            let batch = batch.clone().select(0, order);
            sums.clear();
            for start in (0..samples).step_by(config.minibatch) {
                let length = config.minibatch.min(samples - start);
                sums.push(self.descend(
                    batch.clone().narrow(0, start, length),
                    &rollout.log_std,
                    config,
                ));
            }
        }
        self.updates += 1;
        let sum: Tensor<1> = Tensor::stack::<2>(sums, 0).sum_dim(0).squeeze_dim(0);
        Tensor::cat(vec![sum.mul_scalar(1.0 / samples as f64), explained], 0)
    }

    /// One sample a row.
    fn pack(&mut self, rollout: &Rollout) -> Tensor<2> {
        let advantage = normalise(rollout.advantage.clone());
        let old_value = {
            // The critic's old output in the new normalisation, for the value clip.
            let old = self.scale.mean_and_deviation();
            rollout
                .value
                .clone()
                .mul(old.clone().narrow(0, 1, 1))
                .add(old.narrow(0, 0, 1))
        };
        let target = self.scale.update(rollout.target.clone());
        let new = self.scale.mean_and_deviation();
        let old_value = old_value
            .sub(new.clone().narrow(0, 0, 1))
            .div(new.narrow(0, 1, 1));
        let column = |values: Tensor<1>| values.unsqueeze_dim::<2>(1);
        Tensor::cat(
            vec![
                rollout.observation.clone(),
                rollout.action.clone(),
                rollout.mean.clone(),
                column(rollout.log_prob.clone()),
                column(advantage),
                column(target),
                column(old_value),
            ],
            1,
        )
    }

    /// One gradient step on a minibatch; returns the summed losses over its samples.
    fn descend(
        &mut self,
        minibatch: Tensor<2>,
        old_log_std: &Tensor<1>,
        config: &Ppo,
    ) -> Tensor<1> {
        let length = minibatch.dims()[0];
        let policy = self.policy();
        let kl_coefficient = self.kl_coefficient;
        let piece = length.div_ceil(self.shards);
        let cuts: Vec<usize> = (0..length).step_by(piece).collect();
        let learn = |start: &usize| {
            let shard = minibatch
                .clone()
                .narrow(0, *start, piece.min(length - start));
            gradient(&policy, shard, old_log_std, config, kl_coefficient, length)
        };
        // Pieces are summed in their order, so threads do not change the result.
        let learned: Vec<_> = if cuts.len() == 1 {
            cuts.iter().map(learn).collect()
        } else {
            cuts.par_iter().map(learn).collect()
        };
        let joined = learned
            .into_iter()
            .reduce(|a, b| (a.0.add(b.0), a.1.add(b.1)));
        let Some((gradient, losses)) = joined else {
            unreachable!("a minibatch has samples")
        };
        self.parameters = self.adam.step(
            self.parameters.clone(),
            gradient,
            self.learning_rate,
            config.max_gradient,
        );
        losses
    }

    /// Adapts learning rate and KL penalty to the KL divergence of the last update.
    pub fn adapt(&mut self, kl: f32, steps: u64, config: &Ppo) {
        let kl = f64::from(kl);
        if config.target_kl > 0.0 {
            if kl > 2.0 * config.target_kl {
                self.learning_rate = (self.learning_rate / 1.5).max(self.learning_rate.min(1e-5));
            } else if kl < 0.5 * config.target_kl {
                self.learning_rate = (self.learning_rate * 1.5).min(self.learning_rate.max(1e-2));
            }
        }
        if config.anneal_steps > 0 {
            let done = (steps as f64 / config.anneal_steps as f64).min(1.0);
            let ceiling = config.learning_rate * (1.0 - done * (1.0 - config.final_rate));
            self.learning_rate = if config.target_kl > 0.0 {
                self.learning_rate.min(ceiling)
            } else {
                ceiling
            };
        }
        if config.kl_coefficient > 0.0 {
            if kl > 2.0 * config.kl_target {
                self.kl_coefficient *= 1.5;
            } else if kl < 0.5 * config.kl_target {
                self.kl_coefficient *= 0.5;
            }
        }
    }
}

/// Gradient of the mean loss over `length` samples due to this piece of them, and the summed
/// losses of the piece.
fn gradient(
    policy: &Policy,
    piece: Tensor<2>,
    old_log_std: &Tensor<1>,
    config: &Ppo,
    kl_coefficient: f64,
    length: usize,
) -> (Tensor<1>, Tensor<1>) {
    let width = piece.dims()[1];
    let observations = width - 2 * TRAJECTORY - SCALARS;
    let constant = |start: usize, length: usize| piece.clone().narrow(1, start, length);
    let scalar =
        |i: usize| Tensor::from_inner(constant(width - SCALARS + i, 1).squeeze_dim::<1>(1));
    let study = policy.study(&constant(0, observations));
    let action = Tensor::from_inner(constant(observations, TRAJECTORY));
    let old_mean = Tensor::from_inner(constant(observations + TRAJECTORY, TRAJECTORY));
    let old_log_std = Tensor::from_inner(old_log_std.clone());
    let (old_log_prob, advantage, target, old_value) = (scalar(0), scalar(1), scalar(2), scalar(3));

    let (mean, value) = (study.mean(), study.value());
    let log_std = study.log_std.clone();
    let inverse = log_std.clone().neg().exp().unsqueeze::<2>();

    let noise = action.sub(mean.clone()).mul(inverse.clone());
    let log_prob = sum_rows(noise.square().mul_scalar(-0.5)).sub(
        log_std
            .clone()
            .sum_dim(0)
            .add_scalar(TRAJECTORY as f64 * HALF_LOG_TAU),
    );
    let log_ratio = log_prob.sub(old_log_prob);
    let ratio = log_ratio.exp();
    let clipped = ratio.clone().clamp(1.0 - config.clip, 1.0 + config.clip);
    let surrogate = ratio
        .clone()
        .mul(advantage.clone())
        .min_pair(clipped.clone().mul(advantage))
        .sum_dim(0)
        .neg();

    let error = value.clone().sub(target.clone()).square();
    let value_loss = if config.value_clip > 0.0 {
        let near = old_value.clone().add(
            value
                .sub(old_value)
                .clamp(-config.value_clip, config.value_clip),
        );
        error.max_pair(near.sub(target).square())
    } else {
        error
    };
    let value_loss = value_loss.sum_dim(0).mul_scalar(0.5);

    let samples = piece.dims()[0] as f64;
    let entropy = log_std
        .clone()
        .sum_dim(0)
        .add_scalar(TRAJECTORY as f64 * (0.5 + HALF_LOG_TAU))
        .mul_scalar(samples);
    // KL(old || new) of diagonal Gaussians.
    let moved = old_mean.sub(mean).mul(inverse).square();
    let spread = old_log_std.clone().sub(log_std.clone());
    let kl = sum_rows(moved.mul_scalar(0.5)).sum_dim(0).add(
        spread
            .clone()
            .mul_scalar(2.0)
            .exp()
            .sub_scalar(1.0)
            .mul_scalar(0.5)
            .sub(spread)
            .sum_dim(0)
            .mul_scalar(samples),
    );

    let mut loss = surrogate
        .clone()
        .add(value_loss.clone().mul_scalar(config.value_coefficient));
    if config.entropy_coefficient > 0.0 {
        loss = loss.sub(entropy.clone().mul_scalar(config.entropy_coefficient));
    }
    if kl_coefficient > 0.0 {
        loss = loss.add(kl.clone().mul_scalar(kl_coefficient));
    }
    let gradients = loss.mul_scalar(1.0 / length as f64).backward();
    let left = ratio
        .inner()
        .sub(clipped.inner())
        .abs()
        .greater_elem(0.0)
        .float()
        .sum_dim(0);
    let losses = vec![
        surrogate.inner(),
        value_loss.inner(),
        entropy.inner(),
        kl.inner(),
        left,
    ];
    (study.gradient(&gradients), Tensor::cat(losses, 0))
}

fn sum_rows(values: Tensor<2>) -> Tensor<1> {
    values.sum_dim(1).squeeze_dim(1)
}

/// Zero mean, unit deviation.
fn normalise(values: Tensor<1>) -> Tensor<1> {
    let centred = values.clone().sub(values.mean());
    let deviation = centred.clone().square().mean().sqrt().add_scalar(1e-6);
    centred.div(deviation)
}

fn explained_variance(target: &Tensor<1>, value: &Tensor<1>, scale: &Scale) -> Tensor<1> {
    let scale = scale.mean_and_deviation();
    let value = value
        .clone()
        .mul(scale.clone().narrow(0, 1, 1))
        .add(scale.narrow(0, 0, 1));
    let variance = |of: Tensor<1>| of.clone().sub(of.mean()).square().mean();
    let left = variance(target.clone().sub(value)).div(variance(target.clone()).add_scalar(1e-12));
    left.neg().add_scalar(1.0)
}
