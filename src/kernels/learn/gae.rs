//! Generalised advantage estimation (Schulman et al. 2016, equation 16). Shader:
//! `shaders/learn/gae.wgsl`.

use super::rollout_moments::scale::FIELDS;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::termination;

crate::shader_params! {
    pub struct Params for gae {
        /// Rows of the rollout: agents that act side by side.
        pub rows: u32,
        /// Length of the rollout.
        pub steps: u32,
        /// Discount factor of a step.
        pub gamma: f32,
        /// Decay of later steps' errors: 0 for one-step advantages, 1 for Monte Carlo returns.
        pub lambda: f32,
        /// Terminations after which the value of the final observation goes on, `1 << termination`.
        pub bootstrap: u32,
        /// Steps of `final_value`: 1 if no row has two bootstrapped terminations in the rollout.
        pub final_steps: u32,
        /// Streams of rewards, each with a value of its own.
        pub streams: u32,
        /// The stream that `reward` is of.
        pub stream: u32,
    }
}

/// Queues the shader on `gpu`.
///
/// `reward` and `termination` are `[steps][rows]`; `log_prob_and_value` is `[steps][rows]`, then
/// `[steps][rows][streams]`, `advantage_and_return` `[2][steps][rows][streams]`, `next_value`
/// `[rows][streams]` and `final_value` `[final_steps][rows][streams]`. Values are normalised; `scale`,
/// `[streams][FIELDS]`, begins with the mean and standard deviation that undo it. Advantages and returns
/// are in units of reward.
pub fn launch(
    gpu: &Gpu,
    reward: &Buffer<f32>,
    termination: &Buffer<u32>,
    log_prob_and_value: &Buffer<f32>,
    next_value: &Buffer<f32>,
    final_value: &Buffer<f32>,
    scale: &Buffer<f32>,
    advantage_and_return: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::GAE, params.rows as usize);
    gpu.launch(
        &shader::GAE,
        groups,
        &[
            reward,
            termination,
            log_prob_and_value,
            next_value,
            final_value,
            scale,
            advantage_and_return,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    reward: &[f32],
    termination: &[u32],
    log_prob_and_value: &[f32],
    next_value: &[f32],
    final_value: &[f32],
    scale: &[f32],
    advantage_and_return: &mut [f32],
    params: &Params,
) {
    let rows = params.rows as usize;
    let samples = rows * params.steps as usize;
    let value = &log_prob_and_value[samples..];
    let (of, stream) = (params.streams as usize, params.stream as usize);
    let scale = &scale[FIELDS * stream..];
    let denormalized = |value: f32| value * scale[1] + scale[0];
    for row in 0..rows {
        let (mut after, mut sum) = (denormalized(next_value[row * of + stream]), 0.0);
        for step in (0..params.steps as usize).rev() {
            let at = step * rows + row;
            if termination[at] != termination::RUNNING {
                let from = if params.final_steps == 1 { row } else { at };
                let last = final_value[from * of + stream];
                let goes_on = params.bootstrap >> termination[at] & 1 == 1;
                (after, sum) = (if goes_on { denormalized(last) } else { 0.0 }, 0.0);
            }
            let now = denormalized(value[at * of + stream]);
            sum = reward[at] + params.gamma * after - now + params.gamma * params.lambda * sum;
            advantage_and_return[at * of + stream] = sum;
            advantage_and_return[(samples + at) * of + stream] = sum + now;
            after = now;
        }
    }
}
