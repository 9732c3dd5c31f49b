//! Samples of rollouts, one a row, as the objective reads them.

use crate::gpu::{Array, Device};
use crate::kernels::learn::pack_samples::{Params, launch, twin, width};
use crate::rl::rollout::Rollout;
use rayon::prelude::*;

/// All samples of an update, part after part.
pub struct Samples {
    /// `[count][width]`
    pub rows: Array,
    pub width: usize,
    pub count: usize,
}

impl Samples {
    /// Those of `rollouts`, normalised by `scale`: see [`crate::kernels::learn::rollout_moments`].
    pub fn pack(device: &Device, rollouts: &[Rollout], scale: &Array) -> Self {
        let spec = &rollouts[0].spec;
        let width = width(spec.observation.dim(), spec.action);
        let count: usize = rollouts.iter().map(Rollout::samples).sum();
        let mut rows = Array::zeroed(device, count * width);
        match device {
            Device::Cpu => pack_on_host(rollouts, scale.host(), rows.host_mut(), width),
            Device::Gpu(gpu) => {
                let rollout = &rollouts[0];
                launch(
                    gpu,
                    rollout.observation.buffer(),
                    rollout.action.buffer(),
                    rollout.mean.buffer(),
                    rollout.log_prob_and_value.buffer(),
                    rollout.advantage_and_return.buffer(),
                    scale.buffer(),
                    rows.buffer(),
                    &params(rollout),
                );
            }
        }
        Samples { rows, width, count }
    }
}

fn pack_on_host(rollouts: &[Rollout], scale: &[f32], mut rest: &mut [f32], width: usize) {
    let mut parts = Vec::new();
    for rollout in rollouts {
        let (part, after) = rest.split_at_mut(rollout.samples() * width);
        parts.push((rollout, part));
        rest = after;
    }
    parts.into_par_iter().for_each(|(rollout, rows)| {
        twin(
            rollout.observation.host(),
            rollout.action.host(),
            rollout.mean.host(),
            rollout.log_prob_and_value.host(),
            rollout.advantage_and_return.host(),
            scale,
            rows,
            &params(rollout),
        );
    });
}

fn params(rollout: &Rollout) -> Params {
    Params {
        samples: rollout.samples() as u32,
        observation: rollout.spec.observation.dim() as u32,
        action: rollout.spec.action as u32,
    }
}
