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
    /// What all samples end with, `[samples][..]`, in the rollouts' order.
    ends: Option<Array>,
    /// Samples without what they end with, `[samples][..]`, as far as that differs from `rows`.
    gathered: Array,
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
    /// All samples of `rollouts`, normalised by `scale`; each ends with a row of `ends`, if there are any.
    pub fn new(
        device: &'a Device,
        rollouts: &'a [Rollout],
        scale: Array,
        ends: Option<Array>,
    ) -> Self {
        let spec = &rollouts[0].spec;
        let samples: usize = rollouts.iter().map(Rollout::samples).sum();
        let streams = scale.len() / FIELDS;
        let width = width(spec.observation.dim(), spec.action, streams);
        let gathered = Array::zeroed(device, samples * width);
        let mut batch = Batch {
            device,
            rollouts,
            width: width + ends.as_ref().map_or(0, |ends| ends.len() / samples),
            ends,
            rows: gathered.clone(),
            gathered,
            scale,
            order: Vec::new(),
        };
        if let Device::Cpu = device {
            batch.gather_on_host();
            batch.join_ends(None);
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
            launch(
                gpu,
                &Buffer::from_slice(gpu, &order),
                rollout.observation.buffer(),
                rollout.action.buffer(),
                rollout.mean.buffer(),
                rollout.log_prob_and_value.buffer(),
                rollout.advantage_and_return.buffer(),
                self.scale.buffer(),
                self.gathered.buffer(),
                &self.params(rollout),
            );
            self.join_ends(Some(&order));
        }
        self.order = order;
    }

    /// Makes the rows of what was gathered and what it ends with, in this order or the rollouts'.
    fn join_ends(&mut self, order: Option<&[u32]>) {
        let Some(ends) = &self.ends else {
            self.rows = self.gathered.clone();
            return;
        };
        let samples = self.samples();
        let (own, width) = (self.gathered.len() / samples, ends.len() / samples);
        let ends = match order {
            None => ends.clone(),
            Some(order) => rows::pick(self.device, ends, width, order),
        };
        self.rows = rows::beside(self.device, &[(&self.gathered, own), (&ends, width)]);
    }

    /// The rows of a minibatch of the epoch.
    pub fn minibatch(&self, samples: Range<usize>) -> Rows<'_> {
        match self.device {
            Device::Cpu => Rows::Indices(&self.order[samples]),
            Device::Gpu(_) => Rows::Range(samples),
        }
    }

    fn gather_on_host(&mut self) {
        let (width, streams) = (self.gathered.len() / self.samples(), self.streams());
        let (mut rest, mut parts) = (self.gathered.host_mut(), Vec::new());
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
