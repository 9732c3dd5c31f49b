//! Networks on a GPU: narrow dense ones by custom WGSL kernels ([`fused`]), others layer by layer in burn's
//! tensors ([`layerwise`]), without its autodiff.

mod fused;
mod layerwise;
pub(super) mod moments;
pub mod tensors;

use super::engine::EngineSize;
use super::network::Network;
use super::objective::Objective;
use crate::gpu::{Array, Buffer, Gpu};
use anyhow::Result;
use fused::Fused;
use layerwise::Layerwise;
use std::ops::Range;

/// Networks over one flat vector, on a GPU.
pub struct GpuEngine {
    networks: Vec<Network>,
    kind: Kind,
}

enum Kind {
    Fused(Fused),
    Layerwise(Layerwise),
}

impl GpuEngine {
    /// # Errors
    /// The device's buffers are too small.
    pub fn new(gpu: &Gpu, networks: Vec<Network>, size: EngineSize) -> Result<Self> {
        let kind = match Fused::new(gpu, &networks, size) {
            Some(fused) => Kind::Fused(fused),
            None => Kind::Layerwise(Layerwise::new(gpu, &networks, size)?),
        };
        Ok(GpuEngine { networks, kind })
    }

    /// Whatever the networks' widths, in tensors.
    ///
    /// # Errors
    /// The device's buffers are too small.
    pub fn layerwise(gpu: &Gpu, networks: Vec<Network>, size: EngineSize) -> Result<Self> {
        Ok(GpuEngine {
            kind: Kind::Layerwise(Layerwise::new(gpu, &networks, size)?),
            networks,
        })
    }

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
        let batch = Samples {
            values: observations,
            width: self.networks[network].observation().dim(),
            first,
            count: rows,
        };
        match &self.kind {
            Kind::Fused(fused) => fused.forward(network, parameters, batch, out, out_at),
            Kind::Layerwise(layerwise) => {
                let network = &self.networks[network];
                layerwise.forward(network, parameters, batch, out, out_at);
            }
        }
    }

    pub fn gradient(
        &mut self,
        parameters: &Array,
        samples: &Array,
        width: usize,
        rows: Range<usize>,
        objective: &dyn Objective,
        gradient: &mut Array,
        sums: &mut Array,
    ) {
        let batch = Samples {
            values: samples,
            width,
            first: rows.start,
            count: rows.len(),
        };
        match &mut self.kind {
            Kind::Fused(fused) => fused.gradient(parameters, batch, objective, gradient, sums),
            Kind::Layerwise(layerwise) => {
                let networks = &self.networks;
                layerwise.gradient(networks, parameters, batch, objective, gradient, sums);
            }
        }
    }
}

/// Samples `[..][width]` that begin with observations: `count` of them from `first` on.
#[derive(Clone, Copy)]
struct Samples<'a> {
    values: &'a Array,
    width: usize,
    first: usize,
    count: usize,
}

/// See [`GpuBatch::dims`](super::objective::GpuBatch::dims).
fn dims(gpu: &Gpu, networks: &[Network], size: EngineSize) -> Buffer<u32> {
    let observation = networks
        .first()
        .map_or(0, |first| first.observation().dim());
    let mut dims = vec![observation, size.parameters - size.others(networks)];
    dims.extend(networks.iter().map(Network::outputs));
    let dims: Vec<u32> = dims.into_iter().map(|dim| dim as u32).collect();
    Buffer::from_slice(gpu, &dims)
}
