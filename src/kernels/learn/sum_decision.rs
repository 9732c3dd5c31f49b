//! Rewards of a high level's decision from those of its low level's steps. Shader:
//! `shaders/learn/sum_decision.wgsl`.

use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::termination::RUNNING;

crate::shader_params! {
    pub struct Params for sum_decision {
        /// Rows of the batch.
        pub rows: u32,
        /// Index of the decision's first reward.
        pub at: u32,
        /// Step of the decision, from 0.
        pub step: u32,
        /// Share of a step's reward that the decision's gets.
        pub reward_share: f32,
    }
}

/// Queues the shader on `gpu`.
///
/// `reward`, `style_reward`, `termination` and `group` are `[rows]` of a step. The arrays of the decision are
/// written from `params.at` on, and read but in its first step. What comes after an episode's end does not
/// count; the style reward is the mean over the steps that do.
pub fn launch(
    gpu: &Gpu,
    reward: &Buffer<f32>,
    style_reward: &Buffer<f32>,
    termination: &Buffer<u32>,
    group: &Buffer<u32>,
    decision_reward: &Buffer<f32>,
    decision_style_reward: &Buffer<f32>,
    decision_termination: &Buffer<u32>,
    decision_group: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::SUM_DECISION,
        groups(&shader::SUM_DECISION, params.rows as usize),
        &[
            reward,
            style_reward,
            termination,
            group,
            decision_reward,
            decision_style_reward,
            decision_termination,
            decision_group,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    reward: &[f32],
    style_reward: &[f32],
    termination: &[u32],
    group: &[u32],
    decision_reward: &mut [f32],
    decision_style_reward: &mut [f32],
    decision_termination: &mut [u32],
    decision_group: &mut [u32],
    params: &Params,
) {
    for row in 0..params.rows as usize {
        let at = params.at as usize + row;
        let first = params.step == 0;
        if !first && decision_termination[at] != RUNNING {
            continue;
        }
        let [sum, mean] = match first {
            true => [0.0; 2],
            false => [decision_reward[at], decision_style_reward[at]],
        };
        decision_reward[at] = sum + params.reward_share * reward[row];
        decision_style_reward[at] = mean + (style_reward[row] - mean) / (params.step + 1) as f32;
        decision_termination[at] = termination[row];
        decision_group[at] = group[row];
    }
}
