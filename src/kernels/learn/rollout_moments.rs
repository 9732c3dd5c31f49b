//! What normalises the samples of a rollout. Shader: `shaders/learn/rollout_moments.wgsl`.

use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for rollout_moments {
        /// Samples of the rollout.
        pub samples: u32,
        /// Weight of this rollout in the running moments of the returns.
        pub weight: f32,
        /// Streams of rewards.
        pub streams: u32,
        /// The stream that is looked at.
        pub stream: u32,
    }
}

/// Kinds of situations whose advantages are normalised apart.
pub const GROUPS: usize = 3;
/// Least standard deviation of a group's advantages, of that of all groups together.
const LEAST_OF_ALL: f64 = 0.2;

/// Fields of `scale`.
pub mod scale {
    /// Mean by which the critic's outputs of the rollout were normalised.
    pub const OLD_MEAN: usize = 0;
    /// Standard deviation by which the critic's outputs of the rollout were normalised.
    pub const OLD_STD: usize = 1;
    /// Running mean of the returns, with this rollout's taken in.
    pub const NEW_MEAN: usize = 2;
    /// Running standard deviation of the returns, with this rollout's taken in.
    pub const NEW_STD: usize = 3;
    /// 1 - variance of the critic's error / variance of its target.
    pub const EXPLAINED_VARIANCE: usize = 4;
    /// Weight of the stream's advantages, which the learner decides on.
    pub const WEIGHT: usize = 5;
    /// Mean of the advantages, of each group.
    pub const ADVANTAGE_MEAN: usize = 6;
    /// Standard deviation of the advantages, of each group.
    pub const ADVANTAGE_STD: usize = ADVANTAGE_MEAN + super::GROUPS;
    /// Number of fields.
    pub const FIELDS: usize = ADVANTAGE_STD + super::GROUPS;
}

/// Least standard deviation of the returns.
const MIN_STD: f64 = 1e-3;

/// Queues the shader on `gpu`.
///
/// `log_prob_and_value` is `[samples]`, then `[samples][streams]`, `advantage_and_return`
/// `[2][samples][streams]`: the values normalised, advantages and returns in units of reward. `moments`,
/// `[streams][2]`, are the running mean and mean square of the returns. `scale`,
/// `[streams][scale::FIELDS]`, comes with the old mean and standard deviation, and leaves with all
/// fields. `group` is `[samples]`, below [`GROUPS`].
pub fn launch(
    gpu: &Gpu,
    log_prob_and_value: &Buffer<f32>,
    advantage_and_return: &Buffer<f32>,
    group: &Buffer<u32>,
    moments: &Buffer<f32>,
    scale: &Buffer<f32>,
    params: &Params,
) {
    gpu.launch(
        &shader::ROLLOUT_MOMENTS,
        [1, 1, 1],
        &[
            log_prob_and_value,
            advantage_and_return,
            group,
            moments,
            scale,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    log_prob_and_value: &[f32],
    advantage_and_return: &[f32],
    group: &[u32],
    moments: &mut [f32],
    scale: &mut [f32],
    params: &Params,
) {
    let samples = params.samples as usize;
    let (of, stream) = (params.streams as usize, params.stream as usize);
    let value = &log_prob_and_value[samples..];
    let (advantage, target) = advantage_and_return.split_at(samples * of);
    let moments = &mut moments[2 * stream..][..2];
    let scale = &mut scale[scale::FIELDS * stream..][..scale::FIELDS];
    let mean = |of: &dyn Fn(usize) -> f64| (0..samples).map(of).sum::<f64>() / samples as f64;
    let variance = |of: &dyn Fn(usize) -> f64| {
        let center = mean(of);
        mean(&|i| (of(i) - center).powi(2))
    };
    let target = |i: usize| f64::from(target[i * of + stream]);
    let (old_mean, old_std) = (scale[scale::OLD_MEAN], scale[scale::OLD_STD]);
    let error = |i: usize| target(i) - f64::from(value[i * of + stream] * old_std + old_mean);
    scale[scale::EXPLAINED_VARIANCE] =
        (1.0 - variance(&error) / (variance(&target) + 1e-12)) as f32;

    let weight = f64::from(params.weight);
    let newest = [mean(&target), mean(&|i| target(i).powi(2))];
    for (moment, newest) in moments.iter_mut().zip(newest) {
        *moment = (f64::from(*moment) * (1.0 - weight) + newest * weight) as f32;
    }
    let [mean_return, mean_square] = [moments[0], moments[1]].map(f64::from);
    let spread = (mean_square - mean_return * mean_return).max(MIN_STD * MIN_STD);
    scale[scale::NEW_MEAN] = moments[0];
    scale[scale::NEW_STD] = spread.sqrt() as f32;

    let advantage = |i: usize| f64::from(advantage[i * of + stream]);
    let least = LEAST_OF_ALL * variance(&advantage).sqrt();
    for kind in 0..GROUPS {
        let own: Vec<f64> = (0..samples)
            .filter(|&i| group[i] as usize == kind)
            .map(advantage)
            .collect();
        let count = own.len().max(1) as f64;
        let mean = own.iter().sum::<f64>() / count;
        let variance = own.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / count;
        scale[scale::ADVANTAGE_MEAN + kind] = mean as f32;
        scale[scale::ADVANTAGE_STD + kind] = variance.sqrt().max(least) as f32;
    }
}
