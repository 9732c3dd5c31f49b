//! PPO's loss in tensors (Schulman et al. 2017, equations 7 to 9): its gradient is burn's.

use crate::nn::autodiff::Study;
use crate::motion::features::TRAJECTORY_DIM;
use crate::nn::tensors::sum;
use burn::tensor::Tensor;

/// Columns of a packed sample, so that shuffling is one gather: observation, action, mean, and so many
/// scalars: log probability, advantage, normalised target, the critic's old value in that
/// normalisation.
pub const SCALARS: usize = 4;
/// Sums a minibatch leaves.
pub const LOSSES: usize = 5;
pub const HALF_LOG_TAU: f64 = 0.918_938_533_204_672_7;

/// The choices that make up the loss of a minibatch. See [`super::Ppo`].
#[derive(Clone, Copy, Debug)]
pub struct Terms {
    pub clip: f64,
    pub value_clip: f64,
    pub value_coefficient: f64,
    pub entropy_coefficient: f64,
    pub kl_coefficient: f64,
    /// Of a sample in the mean.
    pub share: f32,
}

/// Gradient of the mean loss over a minibatch with respect to all parameters, and its sums: surrogate,
/// value loss, entropy, KL divergence, samples that left the clip range.
pub(super) fn gradient(
    study: &Study,
    samples: Tensor<2>,
    old_log_std: &Tensor<1>,
    terms: &Terms,
) -> (Tensor<1>, Tensor<1>) {
    let width = samples.dims()[1];
    let observations = width - 2 * TRAJECTORY_DIM - SCALARS;
    let constant = |start: usize, length: usize| samples.clone().narrow(1, start, length);
    let scalar =
        |i: usize| Tensor::from_inner(constant(width - SCALARS + i, 1).squeeze_dim::<1>(1));
    let observation = Tensor::from_inner(constant(0, observations));
    let action = Tensor::from_inner(constant(observations, TRAJECTORY_DIM));
    let old_mean = Tensor::from_inner(constant(observations + TRAJECTORY_DIM, TRAJECTORY_DIM));
    let old_log_std = Tensor::from_inner(old_log_std.clone());
    let (old_log_prob, advantage, target, old_value) = (scalar(0), scalar(1), scalar(2), scalar(3));

    let mean = study.actor.answer(observation.clone());
    let value = study.critic.answer(observation).squeeze_dim::<1>(1);
    let log_std = study.log_std.clone();
    let inverse = log_std.clone().neg().exp().unsqueeze::<2>();

    let noise = action.sub(mean.clone()).mul(inverse.clone());
    let log_prob = sum_rows(noise.square().mul_scalar(-0.5)).sub(
        log_std
            .clone()
            .sum_dim(0)
            .add_scalar(TRAJECTORY_DIM as f64 * HALF_LOG_TAU),
    );
    let log_ratio = log_prob.sub(old_log_prob);
    let ratio = log_ratio.exp();
    let clipped = ratio.clone().clamp(1.0 - terms.clip, 1.0 + terms.clip);
    let least = ratio
        .clone()
        .mul(advantage.clone())
        .min_pair(clipped.clone().mul(advantage));
    let surrogate = sum(least).neg();

    let error = value.clone().sub(target.clone()).square();
    let value_loss = if terms.value_clip > 0.0 {
        let near = old_value.clone().add(
            value
                .sub(old_value)
                .clamp(-terms.value_clip, terms.value_clip),
        );
        error.max_pair(near.sub(target).square())
    } else {
        error
    };
    let value_loss = sum(value_loss).mul_scalar(0.5);

    let count = samples.dims()[0] as f64;
    let entropy = log_std
        .clone()
        .sum_dim(0)
        .add_scalar(TRAJECTORY_DIM as f64 * (0.5 + HALF_LOG_TAU))
        .mul_scalar(count);
    // KL(old || new) of diagonal Gaussians.
    let moved = old_mean.sub(mean).mul(inverse).square();
    let spread = old_log_std.clone().sub(log_std.clone());
    let kl = sum(sum_rows(moved.mul_scalar(0.5))).add(
        spread
            .clone()
            .mul_scalar(2.0)
            .exp()
            .sub_scalar(1.0)
            .mul_scalar(0.5)
            .sub(spread)
            .sum_dim(0)
            .mul_scalar(count),
    );

    let mut loss = surrogate
        .clone()
        .add(value_loss.clone().mul_scalar(terms.value_coefficient));
    if terms.entropy_coefficient > 0.0 {
        loss = loss.sub(entropy.clone().mul_scalar(terms.entropy_coefficient));
    }
    if terms.kl_coefficient > 0.0 {
        loss = loss.add(kl.clone().mul_scalar(terms.kl_coefficient));
    }
    let gradients = loss.mul_scalar(f64::from(terms.share)).backward();
    let left = ratio.inner().sub(clipped.inner()).abs().greater_elem(0.0);
    let left = sum(left.float());
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
