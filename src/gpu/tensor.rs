//! The only bridge between buffers and burn's tensors. Nothing is copied.

use super::Gpu;
use super::buffer::Buffer;
use burn::backend::Wgpu;
use burn::tensor::{DType, Shape, Tensor};
use burn_cubecl::kernel::into_contiguous;
use burn_cubecl::tensor::CubeTensor;
use std::ops::Range;

fn primitive<const D: usize>(tensor: Tensor<D>) -> CubeTensor {
    match tensor.try_into_primitive::<Wgpu>() {
        Ok(primitive) => primitive,
        Err(error) => unreachable!("tensors of a `Gpu` live on wgpu: {error:?}"),
    }
}

/// The buffer behind a tensor without gradients, made contiguous first.
pub fn to_buffer<const D: usize>(tensor: Tensor<D>) -> Buffer<f32> {
    let len = tensor.shape().num_elements();
    let primitive = into_contiguous(primitive(tensor));
    Buffer::wrap(primitive.handle, len)
}

/// A tensor over a buffer's memory. The buffer must hold as many values as the shape asks for.
pub fn from_buffer<const D: usize>(
    gpu: &Gpu,
    buffer: &Buffer<f32>,
    shape: [usize; D],
) -> Tensor<D> {
    assert_eq!(
        buffer.len(),
        shape.iter().product::<usize>(),
        "values in the buffer"
    );
    let primitive = CubeTensor::new_contiguous(
        gpu.client.clone(),
        gpu.cube.clone(),
        Shape::from(shape),
        buffer.handle.clone(),
        DType::F32,
    );
    Tensor::from_primitive::<Wgpu>(primitive)
}

impl Buffer<f32> {
    /// A copy of a range of the values.
    pub(super) fn copy(&self, gpu: &Gpu, range: Range<usize>) -> Self {
        let tensor: Tensor<1> = from_buffer(gpu, self, [self.len()]);
        // A slice alone would be a view of the same memory.
        to_buffer(tensor.slice([range]).mul_scalar(1.0))
    }
}
