//! PPO's loss of every sample and its gradient. Shader: `shaders/learn/loss.wgsl`.

use super::network::{BLOCK, Plan, SUMS};
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::features::TRAJECTORY_DIM;

crate::shader_params! {
    pub struct Params for loss {
        pub rows: u32,
        /// The minibatch's first sample.
        pub start: u32,
        /// Numbers of a sample.
        pub width: u32,
        /// The choices that make up the loss: see [`crate::rl::ppo::Ppo`].
        pub clip: f32,
        pub value_clip: f32,
        pub value_coefficient: f32,
        pub entropy_coefficient: f32,
        pub kl_coefficient: f32,
        /// Of a sample in the mean.
        pub share: f32,
    }
}

const HALF_LOG_TAU: f32 = 0.918_938_5;

pub fn launch(
    gpu: &Gpu,
    plan: &Buffer<u32>,
    samples: &Buffer<f32>,
    parameters: &Buffer<f32>,
    old_log_std: &Buffer<f32>,
    answers: &Buffer<f32>,
    slopes: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(
        &shader::LOSS,
        (params.rows as usize).next_multiple_of(BLOCK),
    );
    let buffers: [&dyn crate::gpu::buffer::Argument; 6] =
        [plan, samples, parameters, old_log_std, answers, slopes];
    gpu.launch(&shader::LOSS, groups, &buffers, params);
}

pub fn twin(
    plan: &Plan,
    samples: &[f32],
    parameters: &[f32],
    old_log_std: &[f32],
    answers: &[f32],
    slopes: &mut [f32],
    params: &Params,
) {
    let [.., actor, critic, judged] = &plan.places[..] else {
        unreachable!("there are two networks, and what the loss adds up");
    };
    let [above_actor, above_critic, judged] =
        [actor, critic, judged].map(|place| place.above as usize);
    let (rows, width) = (params.rows as usize, params.width as usize);
    let (means, values) = answers.split_at(rows * TRAJECTORY_DIM);
    let log_std = &parameters[plan.head.parameters as usize - TRAJECTORY_DIM..];
    for row in 0..rows.next_multiple_of(BLOCK) {
        let mut slope = |column: usize, value: f32| {
            // Rows that fill the last block have no slopes.
            slopes[plan.at(row, column)] = if row < rows { value } else { 0.0 };
        };
        let sample = row.min(rows - 1);
        let (mean, value) = (&means[sample * TRAJECTORY_DIM..], values[sample]);
        let sample = &samples[(params.start as usize + sample) * width..][..width];
        let learned = &sample[sample.len() - 2 * TRAJECTORY_DIM - 4..];
        let (action, learned) = learned.split_at(TRAJECTORY_DIM);
        let (old_mean, learned) = learned.split_at(TRAJECTORY_DIM);
        let [old_log_prob, advantage, target, old_value] = std::array::from_fn(|i| learned[i]);
        let away = |from: &[f32], i: usize| (from[i] - mean[i]) * (-log_std[i]).exp();

        let (mut log_ratio, mut kl, mut entropy) = (-old_log_prob, 0.0, 0.0);
        for i in 0..TRAJECTORY_DIM {
            let (noise, moved) = (away(action, i), away(old_mean, i));
            let spread = old_log_std[i] - log_std[i];
            log_ratio -= 0.5 * noise * noise + log_std[i] + HALF_LOG_TAU;
            kl += 0.5 * (moved * moved + (2.0 * spread).exp() - 1.0) - spread;
            entropy += log_std[i] + 0.5 + HALF_LOG_TAU;
        }
        let ratio = log_ratio.exp();
        let clipped = ratio.clamp(1.0 - params.clip, 1.0 + params.clip);
        // Where the clipped one is less, nothing depends on the ratio.
        let passes = ratio * advantage <= clipped * advantage;
        let pull = if passes { -advantage * ratio } else { 0.0 };
        for i in 0..TRAJECTORY_DIM {
            let (noise, moved) = (away(action, i), away(old_mean, i));
            let doubled = (2.0 * (old_log_std[i] - log_std[i])).exp();
            let by_mean = pull * noise - params.kl_coefficient * moved;
            let by_answer = by_mean * (-log_std[i]).exp();
            slope(above_actor + i, by_answer * params.share);
            let by_noise = pull * (noise * noise - 1.0);
            let by_kl = params.kl_coefficient * (1.0 - doubled - moved * moved);
            let by_log_std = by_noise + by_kl - params.entropy_coefficient;
            slope(judged + i, by_log_std * params.share);
        }

        let error = value - target;
        let step = value - old_value;
        let limit = params.value_clip;
        let near = error - step + step.clamp(-limit, limit);
        // Where the limited change counts, nothing depends on the value.
        let limited = limit > 0.0 && step.abs() > limit && near * near > error * error;
        let by_value = error * params.value_coefficient * params.share;
        slope(above_critic, if limited { 0.0 } else { by_value });
        let sums: [f32; SUMS] = [
            -(ratio * advantage).min(clipped * advantage),
            0.5 * if limited { near * near } else { error * error },
            entropy,
            kl,
            f32::from(ratio != clipped),
        ];
        let sums = sums.into_iter().enumerate();
        sums.for_each(|(i, sum)| slope(judged + TRAJECTORY_DIM + i, sum));
    }
}
