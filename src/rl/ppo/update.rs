//! Improves policy and critic on one rollout.

use super::Ppo;
use crate::nn::adam::Adam;
use crate::nn::gpu::forward::Answering;
use crate::nn::gpu::minibatch_step::Descent as Launched;
use super::loss::{self, LOSSES, Terms};
use crate::nn::cpu::minibatch_step::Descent as Native;
use crate::nn::network::Shape;
use crate::nn::policy::Policy;
use crate::rl::rollout::Rollout;
use crate::rl::value_normalizer::Scale;
use crate::nn::autodiff::Study;
use crate::gpu::{Device, Gpu};
use crate::kernels::rng::permutation;
use crate::nn::tensors::{mean, values, vector};
use anyhow::Context;
use burn::tensor::{Int, Tensor, TensorData};
use std::sync::Arc;

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
    way: Way,
}

/// What runs the networks.
enum Way {
    /// Kernels of our own on the CPU.
    Native,
    /// Our own on a GPU, where all layers are dense.
    Launched(Box<Launched>, Arc<Answering>),
    /// burn's, elsewhere.
    Tensors,
}

impl Way {
    fn of(gpu: &Gpu, shape: &Shape, config: &Ppo) -> Self {
        let descent = Launched::new(gpu, shape, config);
        match descent.zip(Answering::new(gpu, shape, config.batch())) {
            Some((descent, answering)) => Way::Launched(Box::new(descent), Arc::new(answering)),
            None => Way::Tensors,
        }
    }
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

/// First random stream of the shuffles.
const SHUFFLE: u32 = 0x5348_5546;

impl Learner {
    /// Learns from observations of `width` numbers.
    ///
    /// # Errors
    /// A filter of the network does not fit the maps.
    pub fn new(config: &Ppo, width: usize, device: &Device, seed: u32) -> anyhow::Result<Self> {
        let shape = Shape::new(&config.network, width)
            .context("a filter of ppo.network.convolutions is larger than what it sees")?;
        let tensors = device.tensors();
        let way = match device {
            Device::Cpu => Way::Native,
            Device::Gpu(gpu) => Way::of(gpu, &shape, config),
        };
        let parameters = vector(&shape.init(seed, config.init_log_std), &tensors);
        Ok(Learner {
            adam: Adam::new(shape.parameters(), &tensors),
            scale: Scale::new(&tensors),
            way,
            shape,
            parameters,
            learning_rate: config.learning_rate,
            kl_coefficient: config.kl_coefficient,
            updates: 0,
            seed,
        })
    }

    pub fn policy(&self) -> Policy {
        match &self.way {
            Way::Launched(_, answering) => self.shape.launched(answering, &self.parameters),
            Way::Native | Way::Tensors => self.shape.cut(&self.parameters),
        }
    }

    /// One update. Returns `[policy, value, entropy, kl, clip fraction, explained variance]` on the
    /// device, so that nothing waits for it here.
    pub fn update(&mut self, rollout: &Rollout, config: &Ppo) -> Tensor<1> {
        let explained = explained_variance(&rollout.target, &rollout.value, &self.scale);
        let batch = self.pack(rollout);
        let old_log_std = &rollout.log_std;
        let sums = match self.way {
            Way::Native => self.descend_natively(batch, old_log_std, config),
            Way::Launched(..) => self.descend_by_launches(batch, old_log_std, config),
            Way::Tensors => self.descend_in_tensors(batch, old_log_std, config),
        };
        self.updates += 1;
        let samples = rollout.value.dims()[0] as f64;
        Tensor::cat(vec![sums.mul_scalar(1.0 / samples), explained], 0)
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

    /// All passes over a batch, in burn's tensors. Returns the summed losses of the last.
    fn descend_in_tensors(
        &mut self,
        batch: Tensor<2>,
        old_log_std: &Tensor<1>,
        config: &Ppo,
    ) -> Tensor<1> {
        let samples = batch.dims()[0];
        let mut sums = Vec::new();
        for epoch in 0..config.epochs {
            let batch = self.reordered(epoch, &batch);
            sums.clear();
            for start in (0..samples).step_by(config.minibatch_size) {
                let length = config.minibatch_size.min(samples - start);
                let minibatch = batch.clone().narrow(0, start, length);
                let study = Study::new(&self.shape, &self.parameters);
                let terms = terms(config, self.kl_coefficient, length);
                let (gradient, losses) = loss::gradient(&study, minibatch, old_log_std, &terms);
                self.parameters = self.adam.step(
                    self.parameters.clone(),
                    gradient,
                    self.learning_rate,
                    config.max_grad_norm,
                );
                sums.push(losses);
            }
        }
        Tensor::stack::<2>(sums, 0).sum_dim(0).squeeze_dim(0)
    }

    /// The same by launches of our own.
    fn descend_by_launches(
        &mut self,
        batch: Tensor<2>,
        old_log_std: &Tensor<1>,
        config: &Ppo,
    ) -> Tensor<1> {
        let Way::Launched(descent, _) = &self.way else {
            unreachable!("asked for where there is none")
        };
        let moving = descent.begin(&self.parameters, &self.adam);
        let kl_coefficient = self.kl_coefficient;
        for epoch in 0..config.epochs {
            let batch = self.reordered(epoch, &batch);
            descent.pass(
                &moving,
                batch,
                old_log_std,
                &mut self.adam,
                [self.learning_rate, config.max_grad_norm],
                |samples| terms(config, kl_coefficient, samples),
            );
        }
        descent.end(moving, &mut self.parameters, &mut self.adam)
    }

    /// The same on the CPU.
    fn descend_natively(
        &mut self,
        batch: Tensor<2>,
        old_log_std: &Tensor<1>,
        config: &Ppo,
    ) -> Tensor<1> {
        let ([samples, width], device) = (batch.dims(), batch.device());
        let (batch, old_log_std) = (values(batch), values(old_log_std.clone()));
        let mut descent = Native {
            parameters: values(self.parameters.clone()),
            first: values(self.adam.first.clone()),
            second: values(self.adam.second.clone()),
            steps: self.adam.steps,
            rate: self.learning_rate,
            max_norm: config.max_grad_norm,
        };
        let mut sums = [0.0; LOSSES];
        for epoch in 0..config.epochs {
            let order = self.shuffled(epoch, samples);
            sums = [0.0; LOSSES];
            for order in order.chunks(config.minibatch_size) {
                let row = |&i: &u32| &batch[i as usize * width..][..width];
                let rows: Vec<&[f32]> = order.iter().map(row).collect();
                let terms = terms(config, self.kl_coefficient, rows.len());
                let losses = descent.step(&self.shape, &rows, &old_log_std, &terms);
                sums = std::array::from_fn(|i| sums[i] + losses[i]);
            }
        }
        self.parameters = vector(&descent.parameters, &device);
        self.adam.first = vector(&descent.first, &device);
        self.adam.second = vector(&descent.second, &device);
        self.adam.steps = descent.steps;
        vector(&sums, &device)
    }

    /// The samples' order in a pass.
    fn shuffled(&self, epoch: usize, samples: usize) -> Vec<u32> {
        let stream = SHUFFLE + epoch as u32;
        permutation(self.seed, self.updates as u32, stream, samples)
    }

    /// A batch in that order.
    fn reordered(&self, epoch: usize, batch: &Tensor<2>) -> Tensor<2> {
        let samples = batch.dims()[0];
        let order = self.shuffled(epoch, samples).into_iter();
        let order: Vec<i32> = order.map(|i| i as i32).collect();
        let order = TensorData::new(order, [samples]);
        let order = Tensor::<1, Int>::from_data(order, &batch.device());
        batch.clone().select(0, order)
    }

    /// Adapts learning rate and KL penalty to the KL divergence of the last update.
    pub fn adapt(&mut self, kl: f32, steps: u64, config: &Ppo) {
        let kl = f64::from(kl);
        if config.desired_kl > 0.0 {
            if kl > 2.0 * config.desired_kl {
                self.learning_rate = (self.learning_rate / 1.5).max(self.learning_rate.min(1e-5));
            } else if kl < 0.5 * config.desired_kl {
                self.learning_rate = (self.learning_rate * 1.5).min(self.learning_rate.max(1e-2));
            }
        }
        if config.anneal_steps > 0 {
            let done = (steps as f64 / config.anneal_steps as f64).min(1.0);
            let ceiling = config.learning_rate * (1.0 - done * (1.0 - config.final_lr_fraction));
            self.learning_rate = if config.desired_kl > 0.0 {
                self.learning_rate.min(ceiling)
            } else {
                ceiling
            };
        }
        if config.kl_coefficient > 0.0 {
            if kl > 2.0 * config.kl_penalty_target {
                self.kl_coefficient *= 1.5;
            } else if kl < 0.5 * config.kl_penalty_target {
                self.kl_coefficient *= 0.5;
            }
        }
    }
}

/// Of a minibatch of so many samples.
fn terms(config: &Ppo, kl_coefficient: f64, samples: usize) -> Terms {
    Terms {
        clip: config.clip,
        value_clip: config.value_clip,
        value_coefficient: config.value_coefficient,
        entropy_coefficient: config.entropy_coefficient,
        kl_coefficient,
        share: 1.0 / samples as f32,
    }
}

/// Zero mean, unit deviation.
fn normalise(values: Tensor<1>) -> Tensor<1> {
    let centred = values.clone().sub(mean(values));
    let deviation = mean(centred.clone().square()).sqrt().add_scalar(1e-6);
    centred.div(deviation)
}

fn explained_variance(target: &Tensor<1>, value: &Tensor<1>, scale: &Scale) -> Tensor<1> {
    let scale = scale.mean_and_deviation();
    let value = value
        .clone()
        .mul(scale.clone().narrow(0, 1, 1))
        .add(scale.narrow(0, 0, 1));
    let variance = |of: Tensor<1>| mean(of.clone().sub(mean(of)).square());
    let left = variance(target.clone().sub(value)).div(variance(target.clone()).add_scalar(1e-12));
    left.neg().add_scalar(1.0)
}
