//! Networks on a GPU: narrow dense ones by custom WGSL kernels ([`fused`]), others layer by layer in burn's
//! tensors ([`layerwise`]), without its autodiff.

pub(super) mod fused;
pub(super) mod layerwise;
pub(super) mod moments;
pub mod tensors;

use super::engine::EngineSize;
use super::network::Network;
use crate::gpu::{Buffer, Gpu};

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
