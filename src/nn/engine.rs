//! Evaluates and differentiates networks on a device.

use super::cpu::CpuEngine;
use super::extent::{EngineSize, Rows, Samples};
#[cfg(feature = "gpu")]
use super::gpu::{fused::Fused, layerwise::Layerwise};
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
    /// Numbers of an observation.
    observation: usize,
}

enum Backend {
    Cpu(Box<CpuEngine>),
    #[cfg(feature = "gpu")]
    Fused(Box<Fused>),
    #[cfg(feature = "gpu")]
    Layerwise(Box<Layerwise>),
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
        let observation = networks[0].observation().dim();
        let backend = match device {
            Device::Cpu => Backend::Cpu(Box::new(CpuEngine::new(networks, size))),
            #[cfg(feature = "gpu")]
            Device::Gpu(gpu) => match Fused::new(gpu, &networks, size) {
                Some(fused) => Backend::Fused(Box::new(fused)),
                None => Backend::Layerwise(Box::new(Layerwise::new(gpu, networks, size)?)),
            },
            #[cfg(not(feature = "gpu"))]
            Device::Gpu(_) => unreachable!("there is no GPU without the feature `gpu`"),
        };
        Ok(Engine {
            backend,
            observation,
        })
    }

    /// An engine that goes layer by layer, by tensors on a GPU, however narrow the layers are.
    ///
    /// # Errors
    /// The device has no room for that.
    pub fn layerwise(device: &Device, networks: Vec<Network>, size: EngineSize) -> Result<Self> {
        Ok(Engine {
            observation: networks[0].observation().dim(),
            backend: match device {
                Device::Cpu => Backend::Cpu(Box::new(CpuEngine::new(networks, size))),
                #[cfg(feature = "gpu")]
                Device::Gpu(gpu) => {
                    Backend::Layerwise(Box::new(Layerwise::new(gpu, networks, size)?))
                }
                #[cfg(not(feature = "gpu"))]
                Device::Gpu(_) => unreachable!("there is no GPU without the feature `gpu`"),
            },
        })
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
        let samples = Samples {
            values: observations,
            width: self.observation,
            first,
            count: rows,
        };
        match &self.backend {
            Backend::Cpu(engine) => engine.forward(network, parameters, samples, out, out_at),
            #[cfg(feature = "gpu")]
            Backend::Fused(engine) => engine.forward(network, parameters, samples, out, out_at),
            #[cfg(feature = "gpu")]
            Backend::Layerwise(engine) => engine.forward(network, parameters, samples, out, out_at),
        }
    }

    /// Adds the gradient of a penalty to `gradient`: `weight` times the mean, over rows, of the squared norm
    /// of the gradient, with respect to its observation, of the mean of a network's first so many `heads`
    /// (Mescheder, Geiger and Nowozin 2018). Adds the sum of these squared norms to the first of `sums`. The
    /// network's hidden layers are dense ReLUs, whose second derivative is zero; the gradient is therefore exact. The
    /// rows are a range of `samples`, `[..][width]`, which begin with observations.
    ///
    /// # Panics
    /// On a GPU, of an engine that was not made by [`Engine::layerwise`].
    pub fn add_gradient_penalty(
        &self,
        network: usize,
        parameters: &Array,
        samples: &Array,
        width: usize,
        rows: Range<usize>,
        heads: usize,
        weight: f32,
        gradient: &mut Array,
        sums: &mut Array,
    ) {
        let samples = Samples {
            values: samples,
            width,
            first: rows.start,
            count: rows.len(),
        };
        match &self.backend {
            Backend::Cpu(engine) => {
                let (gradient, sums) = (gradient.host_mut(), sums.host_mut());
                engine.add_gradient_penalty(
                    network, parameters, samples, heads, weight, gradient, sums,
                );
            }
            #[cfg(feature = "gpu")]
            Backend::Fused(_) => unreachable!("networks with a penalty take tensors"),
            #[cfg(feature = "gpu")]
            Backend::Layerwise(engine) => {
                engine.add_gradient_penalty(
                    network, parameters, samples, heads, weight, gradient, sums,
                );
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
        #[cfg(feature = "gpu")]
        let in_order = |rows: Rows| match rows {
            Rows::Range(rows) => Samples {
                values: samples,
                width,
                first: rows.start,
                count: rows.len(),
            },
            Rows::Indices(_) => unreachable!("a GPU is given samples in their order"),
        };
        match &mut self.backend {
            Backend::Cpu(engine) => {
                engine.gradient(parameters, samples, width, rows, objective, gradient, sums);
            }
            #[cfg(feature = "gpu")]
            Backend::Fused(engine) => {
                engine.gradient(parameters, in_order(rows), objective, gradient, sums);
            }
            #[cfg(feature = "gpu")]
            Backend::Layerwise(engine) => {
                engine.gradient(parameters, in_order(rows), objective, gradient, sums);
            }
        }
    }
}
