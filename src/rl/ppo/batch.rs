//! Samples of rollouts, one a row, as the objective reads them.

use crate::gpu::{Array, Buffer, Device};
use crate::kernels::learn::gather_samples::{Params, launch, twin, width};
use crate::kernels::learn::rollout_moments::scale::FIELDS;
use crate::nn::{Rows, rows};
use crate::rl::rollout::Rollout;
use rayon::prelude::*;
use std::ops::Range;

/// The samples of an update. On the CPU they stay in the rollouts' order, and a minibatch is a list
/// of rows; on a GPU they are gathered in the order of every epoch, and a minibatch is a range.
pub struct Batch<'a> {
    device: &'a Device,
    rollouts: &'a [Rollout],
    /// What all samples end with, `[samples][more]`, in the rollouts' order.
    more: Option<Array>,
    /// `[streams][FIELDS]`, see [`crate::kernels::learn::rollout_moments::scale`].
    scale: Array,
    /// `[samples][width]`
    pub rows: Array,
    /// Numbers of a row.
    pub width: usize,
    /// Samples in the order of the present epoch.
    order: Vec<u32>,
}

impl<'a> Batch<'a> {
    /// All samples of `rollouts`, normalised by `scale`; each ends with a row of `more`, if there is any.
    pub fn new(
        device: &'a Device,
        rollouts: &'a [Rollout],
        scale: Array,
        more: Option<Array>,
    ) -> Self {
        let spec = &rollouts[0].spec;
        let samples: usize = rollouts.iter().map(Rollout::samples).sum();
        let streams = scale.len() / FIELDS;
        let width = width(spec.observation.dim(), spec.action, streams);
        let mut batch = Batch {
            device,
            rollouts,
            more,
            scale,
            rows: Array::zeroed(device, samples * width),
            width,
            order: Vec::new(),
        };
        if let Device::Cpu = device {
            batch.gather_on_host();
            if let Some(more) = batch.more.take() {
                batch.rows = batch.joined(&more);
                batch.width = batch.rows.len() / samples;
            }
        }
        batch
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.rollouts.iter().map(Rollout::samples).sum()
    }

    /// Begins an epoch that goes through the samples in this order.
    pub fn begin_epoch(&mut self, order: Vec<u32>) {
        if let Device::Gpu(gpu) = self.device {
            let rollout = &self.rollouts[0];
            let own = self.own_width();
            if self.width > own {
                self.rows = Array::zeroed(self.device, self.samples() * own);
            }
            launch(
                gpu,
                &Buffer::from_slice(gpu, &order),
                rollout.observation.buffer(),
                rollout.action.buffer(),
                rollout.mean.buffer(),
                rollout.log_prob_and_value.buffer(),
                rollout.advantage_and_return.buffer(),
                self.scale.buffer(),
                self.rows.buffer(),
                &self.params(rollout),
            );
            if let Some(more) = &self.more {
                let width = more.len() / self.samples();
                self.rows = self.joined(&rows::pick(self.device, more, width, &order));
                self.width = own + width;
            }
        }
        self.order = order;
    }

    /// The rows with those of `more` behind them.
    fn joined(&self, more: &Array) -> Array {
        let parts = [
            (&self.rows, self.own_width()),
            (more, more.len() / self.samples()),
        ];
        rows::beside(self.device, &parts)
    }

    /// Numbers of a row without what it ends with.
    fn own_width(&self) -> usize {
        let spec = &self.rollouts[0].spec;
        width(spec.observation.dim(), spec.action, self.streams())
    }

    /// The rows of a minibatch of the epoch.
    pub fn minibatch(&self, samples: Range<usize>) -> Rows<'_> {
        match self.device {
            Device::Cpu => Rows::Indices(&self.order[samples]),
            Device::Gpu(_) => Rows::Range(samples),
        }
    }

    fn gather_on_host(&mut self) {
        let (width, streams) = (self.width, self.streams());
        let (mut rest, mut parts) = (self.rows.host_mut(), Vec::new());
        for rollout in self.rollouts {
            let (part, after) = rest.split_at_mut(rollout.samples() * width);
            parts.push((rollout, part));
            rest = after;
        }
        let scale = self.scale.host();
        parts.into_par_iter().for_each(|(rollout, rows)| {
            let order: Vec<u32> = (0..rollout.samples() as u32).collect();
            twin(
                &order,
                rollout.observation.host(),
                rollout.action.host(),
                rollout.mean.host(),
                rollout.log_prob_and_value.host(),
                rollout.advantage_and_return.host(),
                scale,
                rows,
                &params(rollout, streams),
            );
        });
    }

    fn streams(&self) -> usize {
        self.scale.len() / FIELDS
    }

    fn params(&self, rollout: &Rollout) -> Params {
        params(rollout, self.streams())
    }
}

fn params(rollout: &Rollout, streams: usize) -> Params {
    Params {
        samples: rollout.samples() as u32,
        observation: rollout.spec.observation.dim() as u32,
        action: rollout.spec.action as u32,
        streams: streams as u32,
    }
}
