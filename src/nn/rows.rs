//! Rows of arrays, on either device: picked, put side by side, replaced.

use crate::gpu::{Array, Buffer, Device};
use crate::kernels::learn::gather_rows;
#[cfg(feature = "gpu")]
use crate::nn::gpu::tensors;
use bytemuck::Pod;
use std::ops::Range;

/// The rows of `from`, `[..][width]`, by their numbers, `[n][width]`.
pub fn pick(device: &Device, from: &Array, width: usize, numbers: &[u32]) -> Array {
    match device {
        Device::Cpu => {
            let mut out = vec![0.0; numbers.len() * width];
            let params = params(numbers.len(), width);
            gather_rows::twin(from.host(), numbers, &mut out, &params);
            Array::Host(out)
        }
        Device::Gpu(_) => gather(device, from, width, &Array::from_slice(device, numbers)),
    }
}

/// [`pick`] by numbers on the device, of rows of any kind.
pub fn gather<T: Pod>(
    device: &Device,
    from: &Array<T>,
    width: usize,
    numbers: &Array<u32>,
) -> Array<T> {
    let params = params(numbers.len(), width);
    match device {
        Device::Cpu => {
            let mut out = vec![T::zeroed(); numbers.len() * width];
            gather_rows::twin(from.host(), numbers.host(), &mut out, &params);
            Array::Host(out)
        }
        Device::Gpu(gpu) => {
            let out = Buffer::empty(gpu, numbers.len() * width);
            gather_rows::launch(gpu, from.buffer(), numbers.buffer(), &out, &params);
            Array::Gpu(out)
        }
    }
}

fn params(rows: usize, width: usize) -> gather_rows::Params {
    gather_rows::Params {
        rows: rows as u32,
        width: width as u32,
    }
}

/// Rows that are those of some parts, `[n][width]` each, side by side.
pub fn beside(device: &Device, parts: &[(&Array, usize)]) -> Array {
    match device {
        Device::Cpu => {
            let rows = parts.first().map_or(0, |(part, width)| part.len() / width);
            let row = |row: usize| {
                let parts = parts.iter();
                parts.flat_map(move |(part, width)| &part.host()[row * width..][..*width])
            };
            Array::Host((0..rows).flat_map(row).copied().collect())
        }
        #[cfg(feature = "gpu")]
        Device::Gpu(gpu) => tensors::beside(gpu, parts),
        #[cfg(not(feature = "gpu"))]
        Device::Gpu(_) => unreachable!("there is no GPU without the feature `gpu`"),
    }
}

/// Some columns of the rows of `from`, `[n][width]`.
pub fn columns(device: &Device, from: &Array, width: usize, range: Range<usize>) -> Array {
    match device {
        Device::Cpu => {
            let rows = from.host().chunks_exact(width);
            Array::Host(rows.flat_map(|row| &row[range.clone()]).copied().collect())
        }
        #[cfg(feature = "gpu")]
        Device::Gpu(gpu) => tensors::columns(gpu, from, width, range),
        #[cfg(not(feature = "gpu"))]
        Device::Gpu(_) => unreachable!("there is no GPU without the feature `gpu`"),
    }
}

/// All values of some arrays, one behind the other.
pub fn join(device: &Device, parts: &[&Array]) -> Array {
    match device {
        Device::Cpu => {
            let parts: Vec<&[f32]> = parts.iter().map(|part| part.host()).collect();
            Array::Host(parts.concat())
        }
        #[cfg(feature = "gpu")]
        Device::Gpu(gpu) => tensors::join(gpu, parts),
        #[cfg(not(feature = "gpu"))]
        Device::Gpu(_) => unreachable!("there is no GPU without the feature `gpu`"),
    }
}

/// Writes `values` over those of `to` from the index `at` on.
pub fn replace(device: &Device, to: &mut Array, at: usize, values: &Array) {
    match device {
        Device::Cpu => to.host_mut()[at..][..values.len()].copy_from_slice(values.host()),
        #[cfg(feature = "gpu")]
        Device::Gpu(gpu) => tensors::replace(gpu, to, at, values),
        #[cfg(not(feature = "gpu"))]
        Device::Gpu(_) => unreachable!("there is no GPU without the feature `gpu`"),
    }
}

/// Adds the sum of all `values` to the first number of `to`.
pub fn add_sum(device: &Device, values: &Array, to: &mut Array) {
    match device {
        Device::Cpu => {
            let sum: f64 = values.host().iter().map(|&value| f64::from(value)).sum();
            to.host_mut()[0] += sum as f32;
        }
        #[cfg(feature = "gpu")]
        Device::Gpu(gpu) => tensors::add_sum(gpu, values, to),
        #[cfg(not(feature = "gpu"))]
        Device::Gpu(_) => unreachable!("there is no GPU without the feature `gpu`"),
    }
}

/// Adds `factor` times a range of `values` to the numbers of the same indices.
pub fn add_scaled(
    device: &Device,
    values: &Array,
    range: Range<usize>,
    factor: f32,
    to: &mut Array,
) {
    match device {
        Device::Cpu => {
            let pairs = to.host_mut()[range.clone()].iter_mut();
            let pairs = pairs.zip(&values.host()[range]);
            pairs.for_each(|(sum, value)| *sum += factor * value);
        }
        #[cfg(feature = "gpu")]
        Device::Gpu(gpu) => tensors::add_scaled(gpu, values, range, factor, to),
        #[cfg(not(feature = "gpu"))]
        Device::Gpu(_) => unreachable!("there is no GPU without the feature `gpu`"),
    }
}
