//! Samples of a rollout in the order of an epoch, one a row, as the objective reads them. Shader:
//! `shaders/learn/gather_samples.wgsl`.

use super::rollout_moments::scale;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for gather_samples {
        /// Samples of the rollout.
        pub samples: u32,
        /// Numbers of an observation.
        pub observation: u32,
        /// Numbers of an action.
        pub action: u32,
        /// Streams of rewards.
        pub streams: u32,
    }
}

/// Scalars at the end of a row: log probability, the sum of the streams' advantages, their normalised returns, the critic's old outputs in the new normalisation.
pub fn scalars(streams: usize) -> usize {
    2 + 2 * streams
}

/// Numbers of a row: observation, action, mean, scalars.
pub fn width(observation: usize, action: usize, streams: usize) -> usize {
    observation + 2 * action + scalars(streams)
}

/// Queues the shader on `gpu`.
///
/// `order` is `[samples]`, `observation` `[samples][observation]`, `action` and `mean` are
/// `[samples][action]`, `log_prob_and_value` is `[samples]`, then `[samples][streams]`,
/// `advantage_and_return` `[2][samples][streams]`; `scale`, `[streams][scale::FIELDS]`, has the fields of [`rollout_moments`](super::rollout_moments), and `samples` is `[samples][width]`,
/// see [`width`].
pub fn launch(
    gpu: &Gpu,
    order: &Buffer<u32>,
    observation: &Buffer<f32>,
    action: &Buffer<f32>,
    mean: &Buffer<f32>,
    log_prob_and_value: &Buffer<f32>,
    advantage_and_return: &Buffer<f32>,
    scale: &Buffer<f32>,
    samples: &Buffer<f32>,
    params: &Params,
) {
    let groups = [
        params.samples.min(GROUPS),
        params.samples.div_ceil(GROUPS),
        1,
    ];
    gpu.launch(
        &shader::GATHER_SAMPLES,
        groups,
        &[
            order,
            observation,
            action,
            mean,
            log_prob_and_value,
            advantage_and_return,
            scale,
            samples,
        ],
        params,
    );
}

/// Workgroups along x: WebGPU launches no more in a dimension.
const GROUPS: u32 = 65_535;

/// The shader's computation on the host.
pub fn twin(
    order: &[u32],
    observation: &[f32],
    action: &[f32],
    mean: &[f32],
    log_prob_and_value: &[f32],
    advantage_and_return: &[f32],
    scale: &[f32],
    samples: &mut [f32],
    params: &Params,
) {
    let count = params.samples as usize;
    let (seen, acted) = (params.observation as usize, params.action as usize);
    let (log_prob, value) = log_prob_and_value.split_at(count);
    let of = params.streams as usize;
    let (advantage, target) = advantage_and_return.split_at(count * of);
    let rows = samples.chunks_exact_mut(width(seen, acted, of));
    for (row, &from) in rows.zip(order) {
        let from = from as usize;
        let (row_observation, row) = row.split_at_mut(seen);
        let (row_action, row) = row.split_at_mut(acted);
        let (row_mean, row_scalars) = row.split_at_mut(acted);
        row_observation.copy_from_slice(&observation[from * seen..][..seen]);
        row_action.copy_from_slice(&action[from * acted..][..acted]);
        row_mean.copy_from_slice(&mean[from * acted..][..acted]);
        let (row_policy, row_values) = row_scalars.split_at_mut(2);
        row_policy.copy_from_slice(&[log_prob[from], 0.0]);
        for (stream, scale) in scale.chunks_exact(scale::FIELDS).enumerate() {
            let [old_mean, old_std, new_mean, new_std] = std::array::from_fn(|i| scale[i]);
            let from = from * of + stream;
            row_policy[1] += advantage[from];
            row_values[stream] = (target[from] - new_mean) / new_std;
            row_values[of + stream] = (value[from] * old_std + old_mean - new_mean) / new_std;
        }
    }
}
