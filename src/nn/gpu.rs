//! Networks on a GPU: narrow dense ones by custom WGSL kernels ([`fused`]), others layer by layer in burn's
//! tensors ([`layerwise`]), without its autodiff.

mod fused;
mod layerwise;
pub mod tensors;

use super::engine::{EngineSize, Rows, SamplesInOrder, Shuffled};
use super::network::Network;
use super::objective::Objective;
use crate::gpu::tensor::{from_buffer, to_buffer};
use crate::gpu::{Array, Buffer, Device, Gpu};
use anyhow::Result;
use burn::tensor::{Int, Tensor, TensorData};
use fused::Fused;
use layerwise::Layerwise;
use std::ops::Range;

/// Networks over one flat vector, on a GPU.
pub struct GpuEngine {
    networks: Vec<Network>,
    kind: Kind,
    size: EngineSize,
    gpu: Gpu,
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
        Ok(GpuEngine {
            networks,
            kind,
            size,
            gpu: gpu.clone(),
        })
    }

    /// Whatever the networks' widths, in tensors.
    ///
    /// # Errors
    /// The device's buffers are too small.
    pub fn layerwise(gpu: &Gpu, networks: Vec<Network>, size: EngineSize) -> Result<Self> {
        Ok(GpuEngine {
            kind: Kind::Layerwise(Layerwise::new(gpu, &networks, size)?),
            networks,
            size,
            gpu: gpu.clone(),
        })
    }

    pub fn forward(
        &self,
        network: usize,
        parameters: &Array,
        rows: Rows,
        out: &mut Array,
        out_at: usize,
    ) {
        match &self.kind {
            Kind::Fused(fused) => fused.forward(network, parameters, rows, out, out_at),
            Kind::Layerwise(layerwise) => {
                let network = &self.networks[network];
                layerwise.forward(network, parameters, rows, out, out_at);
            }
        }
    }

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
        let SamplesInOrder::Gpu(values) = &samples.samples else {
            unreachable!("samples of a GPU were expected")
        };
        let rows = Rows {
            values,
            width: samples.width,
            first: minibatch.start,
            count: minibatch.len(),
        };
        match &mut self.kind {
            Kind::Fused(fused) => {
                fused.gradient(parameters, rows, objective, gradient, sums, begin);
            }
            Kind::Layerwise(layerwise) => {
                let networks = &self.networks;
                layerwise.gradient(networks, parameters, rows, objective, gradient, sums, begin);
            }
        }
    }
}

/// The rows `[..][width]` of the indices `order`.
pub(super) fn reordered(gpu: &Gpu, rows: &Buffer<f32>, width: usize, order: &[u32]) -> Array {
    let device = Device::from(gpu.clone()).tensors();
    let order: Vec<i32> = order.iter().map(|&i| i as i32).collect();
    let length = order.len();
    let order = Tensor::<1, Int>::from_data(TensorData::new(order, [length]), &device);
    let rows: Tensor<2> = from_buffer(gpu, rows, [rows.len() / width, width]);
    Array::Gpu(to_buffer(rows.select(0, order)))
}
