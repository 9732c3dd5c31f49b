//! Dimensions that the shaders of an objective read.

use crate::gpu::{Buffer, Gpu};
use crate::nn::extent::EngineSize;
use crate::nn::network::Network;

/// See [`GpuBatch::dims`](crate::nn::objective::GpuBatch::dims).
pub fn dims(gpu: &Gpu, networks: &[Network], size: EngineSize) -> Buffer<u32> {
    let observation = networks
        .first()
        .map_or(0, |first| first.observation().dim());
    let mut dims = vec![observation, size.parameters - size.others(networks)];
    dims.extend(networks.iter().map(Network::outputs));
    let dims: Vec<u32> = dims.into_iter().map(|dim| dim as u32).collect();
    Buffer::from_slice(gpu, &dims)
}
