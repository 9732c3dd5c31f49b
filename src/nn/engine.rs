//! Evaluates and differentiates networks on a device.

use super::cpu::CpuEngine;
use super::gpu::{GpuEngine, reordered};
use super::network::Network;
use super::objective::Objective;
use crate::gpu::{Array, Device};
use anyhow::Result;
use std::ops::Range;

/// One or more networks over the same observations, whose parameters are one flat vector.
///
/// The flat vector holds the networks' parameters one after another and, behind them, any others that the
/// objective knows of.
pub struct Engine {
    backend: Backend,
}

enum Backend {
    Cpu(CpuEngine),
    Gpu(Box<GpuEngine>),
}

/// The extent of a learning problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EngineSize {
    /// Length of the flat vector.
    pub parameters: usize,
    /// Sums of the objective.
    pub sums: usize,
    /// The most rows that are evaluated at once.
    pub max_rows: usize,
    /// The most rows of a minibatch.
    pub minibatch: usize,
}

/// Rows `[..][width]` that begin with an observation: `count` of them from `first` on.
#[derive(Clone, Copy)]
pub struct Rows<'a> {
    pub values: &'a Array,
    pub width: usize,
    pub first: usize,
    pub count: usize,
}

/// Samples `[..][width]`, observations first, in an order of their own.
pub struct Shuffled<'a> {
    pub(super) samples: SamplesInOrder<'a>,
    pub(super) width: usize,
}

pub(super) enum SamplesInOrder<'a> {
    /// Read where they lie.
    Host(&'a [f32], &'a [u32]),
    /// Copied into the order.
    Gpu(Array),
}

impl<'a> Shuffled<'a> {
    /// The samples of the indices `order`.
    pub fn new(device: &Device, samples: &'a Array, width: usize, order: &'a [u32]) -> Self {
        let samples = match device {
            Device::Cpu => SamplesInOrder::Host(samples.host(), order),
            Device::Gpu(gpu) => SamplesInOrder::Gpu(reordered(gpu, samples.buffer(), width, order)),
        };
        Shuffled { samples, width }
    }
}

impl Engine {
    /// What `networks` need on `device`, made once. They must lie in the flat vector one after another,
    /// from its beginning.
    ///
    /// # Errors
    /// The device has no room for that.
    pub fn new(device: &Device, networks: Vec<Network>, size: EngineSize) -> Result<Self> {
        let backend = match device {
            Device::Cpu => Backend::Cpu(CpuEngine::new(networks, size)),
            Device::Gpu(gpu) => Backend::Gpu(Box::new(GpuEngine::new(gpu, networks, size)?)),
        };
        Ok(Engine { backend })
    }

    /// Writes the outputs `[rows.count][outputs]` of a network to `out` from the index `out_at` on.
    pub fn forward(
        &self,
        network: usize,
        parameters: &Array,
        rows: Rows,
        out: &mut Array,
        out_at: usize,
    ) {
        match &self.backend {
            Backend::Cpu(engine) => engine.forward(network, parameters, rows, out, out_at),
            Backend::Gpu(engine) => engine.forward(network, parameters, rows, out, out_at),
        }
    }

    /// Writes the gradient of the mean loss over the rows `minibatch` of `samples` with respect to the flat
    /// vector, and adds the objective's sums over these rows to `sums`, which they `begin` or go on with.
    pub fn gradient(
        &mut self,
        parameters: &Array,
        samples: &Shuffled,
        minibatch: Range<usize>,
        objective: &dyn Objective,
        gradient: &mut Array,
        sums: &mut Array,
        begin: bool,
    ) {
        match &mut self.backend {
            Backend::Cpu(engine) => engine.gradient(
                parameters, samples, minibatch, objective, gradient, sums, begin,
            ),
            Backend::Gpu(engine) => engine.gradient(
                parameters, samples, minibatch, objective, gradient, sums, begin,
            ),
        }
    }
}
