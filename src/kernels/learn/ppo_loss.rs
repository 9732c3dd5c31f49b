//! PPO's loss of every row and its gradient (Schulman et al. 2017, equations 7 to 9), with a penalty on the
//! KL divergence of the new policy from the old and a bound on the critic's change. Shader:
//! `shaders/learn/ppo_loss.wgsl`.

use super::gather_samples::scalars;
use crate::gpu::{Argument, Buffer, Gpu, groups, shader};

crate::shader_params! {
    pub struct Params for ppo_loss {
        /// Rows of the minibatch.
        pub rows: u32,
        /// The first sample.
        pub start: u32,
        /// Numbers of a sample.
        pub width: u32,
        /// Clip range of the probability ratio.
        pub clip: f32,
        /// Largest change of the critic's output that is rewarded; 0 for no limit.
        pub value_clip: f32,
        /// Weight of the value loss.
        pub value_coefficient: f32,
        /// Weight of the entropy bonus.
        pub entropy_coefficient: f32,
        /// Weight of the penalty on the KL divergence.
        pub kl_coefficient: f32,
        /// 1 where standard deviations are learned, 0 where they stay.
        pub std_coefficient: f32,
        /// 1 / rows of the mean.
        pub inv_count: f32,
    }
}

/// What is added up besides the gradient of `log_std`: surrogate, value loss, entropy, KL divergence,
/// samples out of the clip range.
pub const SUMS: usize = shader::ppo_loss::constants::SUMS as usize;
const HALF_LOG_TAU: f32 = 0.918_938_5;

/// Queues the shader on `gpu`.
///
/// `dims`: numbers of an observation, where `log_std` begins, numbers of an action, values.
pub fn launch(
    gpu: &Gpu,
    dims: &Buffer<u32>,
    samples: &Buffer<f32>,
    parameters: &Buffer<f32>,
    old_log_std: &Buffer<f32>,
    outputs: &Buffer<f32>,
    output_grads: &Buffer<f32>,
    extras: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::PPO_LOSS, params.rows as usize);
    let buffers: [&dyn Argument; 7] = [
        dims,
        samples,
        parameters,
        old_log_std,
        outputs,
        output_grads,
        extras,
    ];
    gpu.launch(&shader::PPO_LOSS, groups, &buffers, params);
}

/// The actor's part for `rows`, whose last numbers are action, old mean, log probability, advantage,
/// as many targets as there are `values`, old values. Writes the gradients over the `means`, `[rows][action]`, and adds to `extras`, `[action + SUMS]`.
pub fn actor(
    log_std: &[f32],
    old_log_std: &[f32],
    rows: &[&[f32]],
    means: &mut [f32],
    extras: &mut [f32],
    values: usize,
    params: &Params,
) {
    let actions = log_std.len();
    let inv_std: Vec<f32> = log_std.iter().map(|log| (-log).exp()).collect();
    let log_std_diff: Vec<f32> = old_log_std
        .iter()
        .zip(log_std)
        .map(|(o, n)| o - n)
        .collect();
    let var_ratio: Vec<f32> = log_std_diff.iter().map(|diff| (2.0 * diff).exp()).collect();
    let normaliser = log_std.iter().sum::<f32>() + actions as f32 * HALF_LOG_TAU;
    let entropy = normaliser + 0.5 * actions as f32;
    // The KL divergence of Gaussians of the same mean.
    let kl_of_std = var_ratio.iter().zip(&log_std_diff);
    let kl_of_std: f32 = kl_of_std
        .map(|(ratio, diff)| 0.5 * (ratio - 1.0) - diff)
        .sum();
    let (d_log_std, sums) = extras.split_at_mut(actions);
    for (row, mean) in rows.iter().zip(means.chunks_exact_mut(actions)) {
        let (_, row) = row.split_at(row.len() - 2 * actions - scalars(values));
        let (action, row) = row.split_at(actions);
        let (old_mean, scalars) = row.split_at(actions);
        let (old_log_prob, advantage) = (scalars[0], scalars[1]);
        let (mut noise_square, mut mean_diff_square) = (0.0, 0.0);
        for i in 0..actions {
            let noise = (action[i] - mean[i]) * inv_std[i];
            let mean_diff = (old_mean[i] - mean[i]) * inv_std[i];
            noise_square += noise * noise;
            mean_diff_square += mean_diff * mean_diff;
        }
        let ratio = (-0.5 * noise_square - normaliser - old_log_prob).exp();
        let clipped = ratio.clamp(1.0 - params.clip, 1.0 + params.clip);
        // Where the clipped objective is less, nothing depends on the ratio.
        let unclipped = ratio * advantage <= clipped * advantage;
        let d_log_prob = if unclipped { -advantage * ratio } else { 0.0 };
        for i in 0..actions {
            let noise = (action[i] - mean[i]) * inv_std[i];
            let mean_diff = (old_mean[i] - mean[i]) * inv_std[i];
            let d_mean = d_log_prob * noise - params.kl_coefficient * mean_diff;
            mean[i] = d_mean * inv_std[i] * params.inv_count;
            let d_std = d_log_prob * (noise * noise - 1.0);
            let kl_std = params.kl_coefficient * (1.0 - var_ratio[i] - mean_diff * mean_diff);
            let d_std = d_std + kl_std - params.entropy_coefficient;
            d_log_std[i] += params.std_coefficient * d_std * params.inv_count;
        }
        sums[0] -= (ratio * advantage).min(clipped * advantage);
        sums[2] += entropy;
        sums[3] += 0.5 * mean_diff_square + kl_of_std;
        sums[4] += f32::from(ratio != clipped);
    }
}

/// The critic's part: writes the gradients over its `outputs`, `[rows][values]`.
pub fn critic(
    rows: &[&[f32]],
    outputs: &mut [f32],
    extras: &mut [f32],
    values: usize,
    params: &Params,
) {
    let value_loss = extras.len() - SUMS + 1;
    let pairs = rows.iter().flat_map(|row| {
        let (targets, old_values) = row[row.len() - 2 * values..].split_at(values);
        targets.iter().zip(old_values)
    });
    for ((target, old_value), value) in pairs.zip(outputs) {
        let error = *value - target;
        let change = *value - old_value;
        let limit = params.value_clip;
        let near = error - change + change.clamp(-limit, limit);
        // Where the limited change counts, nothing depends on the value.
        let limited = limit > 0.0 && change.abs() > limit && near * near > error * error;
        extras[value_loss] += 0.5 * if limited { near * near } else { error * error };
        let d_value = error * params.value_coefficient * params.inv_count;
        *value = if limited { 0.0 } else { d_value };
    }
}
