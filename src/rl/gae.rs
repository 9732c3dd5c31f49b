//! Generalised advantage estimation over a rollout, on either device.
//!
//! Rewards of different sources are streams: each has a value, advantages and returns of its own.

use super::rollout::Rollout;
use crate::gpu::{Array, Device};
use crate::kernels::learn::gae::{Params, launch, twin};

/// Where the rewards of a stream come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RewardSource {
    /// The environment.
    Task,
    /// A discriminator.
    Style,
    /// An encoder of skills.
    Skill,
}

/// Values that the critic gives to what lies behind a rollout, normalised.
pub struct Bootstrap {
    /// `[rows][streams]`, of the observation after the last step.
    pub next_value: Array,
    /// `[final_steps][rows][streams]`, of the final observations.
    pub final_value: Array,
}

/// Fills in the advantages and returns of a rollout, of each stream. `scale`, `[streams][FIELDS]`, begins
/// with the mean and standard deviation that undo the normalisation of values.
pub fn gae(
    device: &Device,
    rollout: &mut Rollout,
    bootstrap: &Bootstrap,
    scale: &Array,
    sources: &[RewardSource],
    gamma: f32,
    lambda: f32,
) {
    for (stream, source) in sources.iter().enumerate() {
        let params = params(rollout, [sources.len(), stream], [gamma, lambda]);
        estimate(device, rollout, bootstrap, scale, *source, &params);
    }
}

fn params(rollout: &Rollout, [streams, stream]: [usize; 2], [gamma, lambda]: [f32; 2]) -> Params {
    Params {
        rows: rollout.spec.rows() as u32,
        steps: rollout.steps as u32,
        gamma,
        lambda,
        bootstrap: rollout.spec.bootstrap,
        final_steps: rollout.spec.final_steps(rollout.steps) as u32,
        streams: streams as u32,
        stream: stream as u32,
    }
}

fn estimate(
    device: &Device,
    rollout: &mut Rollout,
    bootstrap: &Bootstrap,
    scale: &Array,
    source: RewardSource,
    params: &Params,
) {
    let reward = match source {
        RewardSource::Task => &rollout.reward,
        RewardSource::Style => &rollout.style_reward,
        RewardSource::Skill => &rollout.skill_reward,
    };
    match device {
        Device::Cpu => twin(
            reward.host(),
            rollout.termination.host(),
            rollout.log_prob_and_value.host(),
            bootstrap.next_value.host(),
            bootstrap.final_value.host(),
            scale.host(),
            rollout.advantage_and_return.host_mut(),
            params,
        ),
        Device::Gpu(gpu) => launch(
            gpu,
            reward.buffer(),
            rollout.termination.buffer(),
            rollout.log_prob_and_value.buffer(),
            bootstrap.next_value.buffer(),
            bootstrap.final_value.buffer(),
            scale.buffer(),
            rollout.advantage_and_return.buffer(),
            params,
        ),
    }
}
