//! Evaluates and differentiates networks on a device.

use super::cpu::CpuEngine;
#[cfg(feature = "gpu")]
use super::gpu::GpuEngine;
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
    #[cfg(feature = "gpu")]
    Gpu(Box<GpuEngine>),
}

/// Which of the samples make up a minibatch.
#[derive(Clone, Debug)]
pub enum Rows<'a> {
    /// Those of a range.
    Range(Range<usize>),
    /// Those of a list; on the CPU only.
    Indices(&'a [u32]),
}

impl Engine {
    /// What `networks` need on `device`, made once. They must lie one after another at the beginning of
    /// a flat vector of so many `parameters`. The objective adds up so many `extras`, at most `max_rows`
    /// rows are evaluated at once, and at most `minibatch` learned from.
    ///
    /// # Errors
    /// The device has no room for that.
    pub fn new(
        device: &Device,
        networks: Vec<Network>,
        parameters: usize,
        extras: usize,
        max_rows: usize,
        minibatch: usize,
    ) -> Result<Self> {
        let size = EngineSize {
            parameters,
            extras,
            max_rows,
            minibatch,
        };
        let backend = match device {
            Device::Cpu => Backend::Cpu(CpuEngine::new(networks, size)),
            #[cfg(feature = "gpu")]
            Device::Gpu(gpu) => Backend::Gpu(Box::new(GpuEngine::new(gpu, networks, size)?)),
            #[cfg(not(feature = "gpu"))]
            Device::Gpu(_) => unreachable!("there is no GPU without the feature `gpu`"),
        };
        Ok(Engine { backend })
    }

    /// Writes the outputs `[rows][outputs]` of a network to `out` from the index `out_at` on, for so many
    /// of the `observations`, `[..][observation]`, from the row `first` on.
    pub fn forward(
        &self,
        network: usize,
        parameters: &Array,
        observations: &Array,
        first: usize,
        rows: usize,
        out: &mut Array,
        out_at: usize,
    ) {
        match &self.backend {
            Backend::Cpu(engine) => {
                engine.forward(network, parameters, observations, first, rows, out, out_at);
            }
            #[cfg(feature = "gpu")]
            Backend::Gpu(engine) => {
                engine.forward(network, parameters, observations, first, rows, out, out_at);
            }
        }
    }

    /// Writes the gradient of the loss with respect to the flat vector, over some rows of `samples`,
    /// `[..][width]`, which begin with observations; and adds the objective's sums over these rows to
    /// `sums`.
    pub fn gradient(
        &mut self,
        parameters: &Array,
        samples: &Array,
        width: usize,
        rows: Rows,
        objective: &dyn Objective,
        gradient: &mut Array,
        sums: &mut Array,
    ) {
        match &mut self.backend {
            Backend::Cpu(engine) => {
                engine.gradient(parameters, samples, width, rows, objective, gradient, sums);
            }
            #[cfg(feature = "gpu")]
            Backend::Gpu(engine) => {
                let Rows::Range(rows) = rows else {
                    unreachable!("a GPU is given samples in their order")
                };
                engine.gradient(parameters, samples, width, rows, objective, gradient, sums);
            }
        }
    }
}

/// What [`Engine::new`] is told of what there is to evaluate and to learn.
#[derive(Clone, Copy, Debug)]
pub struct EngineSize {
    /// Length of the flat vector.
    pub parameters: usize,
    /// Numbers that the objective adds up.
    pub extras: usize,
    /// The most rows evaluated at once.
    pub max_rows: usize,
    /// The most rows learned from at once.
    pub minibatch: usize,
}

impl EngineSize {
    /// Parameters behind those of the networks.
    pub(super) fn others(&self, networks: &[Network]) -> usize {
        self.parameters - networks.last().map_or(0, |last| last.span().end)
    }
}
