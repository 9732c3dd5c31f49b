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
    let columns = [log_prob_and_value, advantage_and_return];
    over_ranks(columns, group, moments, scale, params, |_| {});
}

/// [`twin`] over the samples of all ranks, whose sums `together` adds up. `params.samples` are this rank's.
pub fn over_ranks(
    [log_prob_and_value, advantage_and_return]: [&[f32]; 2],
    group: &[u32],
    moments: &mut [f32],
    scale: &mut [f32],
    params: &Params,
    mut together: impl FnMut(&mut [f64]),
) {
    let samples = params.samples as usize;
    let (of, stream) = (params.streams as usize, params.stream as usize);
    let value = &log_prob_and_value[samples..];
    let (advantage, target) = advantage_and_return.split_at(samples * of);
    let moments = &mut moments[2 * stream..][..2];
    let scale = &mut scale[scale::FIELDS * stream..][..scale::FIELDS];
    let target = |i: usize| f64::from(target[i * of + stream]);
    let (old_mean, old_std) = (scale[scale::OLD_MEAN], scale[scale::OLD_STD]);
    let error = |i: usize| target(i) - f64::from(value[i * of + stream] * old_std + old_mean);
    let advantage = |i: usize| f64::from(advantage[i * of + stream]);
    let is_of = |i: usize, kind: usize| group[i] as usize == kind;
    let sum = |of: &dyn Fn(usize) -> f64| (0..samples).map(of).sum::<f64>();
    let sum_of = |kind: usize, of: &dyn Fn(usize) -> f64| -> f64 {
        let own = (0..samples).filter(|&i| is_of(i, kind));
        own.map(of).sum()
    };

    let mut sums = [0.0; 5 + 2 * GROUPS];
    sums[..5].copy_from_slice(&[
        samples as f64,
        sum(&target),
        sum(&|i| target(i).powi(2)),
        sum(&error),
        sum(&advantage),
    ]);
    for kind in 0..GROUPS {
        sums[5 + kind] = sum_of(kind, &|_| 1.0);
        sums[5 + GROUPS + kind] = sum_of(kind, &advantage);
    }
    together(&mut sums);
    let [mean_target, mean_square, mean_error, mean_advantage] =
        [1, 2, 3, 4].map(|at| sums[at] / sums[0]);
    let count = |kind: usize| sums[5 + kind].max(1.0);
    let mean = |kind: usize| sums[5 + GROUPS + kind] / count(kind);

    let mut squares = [0.0; 3 + GROUPS];
    squares[0] = sum(&|i| (error(i) - mean_error).powi(2));
    squares[1] = sum(&|i| (target(i) - mean_target).powi(2));
    squares[2] = sum(&|i| (advantage(i) - mean_advantage).powi(2));
    for kind in 0..GROUPS {
        squares[3 + kind] = sum_of(kind, &|i| (advantage(i) - mean(kind)).powi(2));
    }
    together(&mut squares);
    let variance = |at: usize| squares[at] / sums[0];
    scale[scale::EXPLAINED_VARIANCE] = (1.0 - variance(0) / (variance(1) + 1e-12)) as f32;

    let weight = f64::from(params.weight);
    let newest = [mean_target, mean_square];
    for (moment, newest) in moments.iter_mut().zip(newest) {
        *moment = (f64::from(*moment) * (1.0 - weight) + newest * weight) as f32;
    }
    let [mean_return, mean_square] = [moments[0], moments[1]].map(f64::from);
    let spread = (mean_square - mean_return * mean_return).max(MIN_STD * MIN_STD);
    scale[scale::NEW_MEAN] = moments[0];
    scale[scale::NEW_STD] = spread.sqrt() as f32;

    let least = LEAST_OF_ALL * variance(2).sqrt();
    for kind in 0..GROUPS {
        let spread = (squares[3 + kind] / count(kind)).sqrt();
        scale[scale::ADVANTAGE_MEAN + kind] = mean(kind) as f32;
        scale[scale::ADVANTAGE_STD + kind] = spread.max(least) as f32;
    }
}
