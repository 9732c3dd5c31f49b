//! Between tensors and plain arrays on the host.

use crate::gpu::tensor::{from_buffer, to_buffer};
use crate::gpu::{Array, Gpu};
use burn::tensor::{Device, Tensor, TensorData};

/// A tensor's values, copied to the host: waits for the device.
///
/// # Errors
/// The device was lost, or an operation before this one failed.
pub fn read<const D: usize>(tensor: Tensor<D>) -> anyhow::Result<Vec<f32>> {
    let data = tensor
        .try_into_data()
        .map_err(|error| anyhow::anyhow!("the device failed: {error}"))?;
    data.try_into_vec::<f32>()
        .map_err(|error| anyhow::anyhow!("a tensor is not f32: {error:?}"))
}

/// Values of a CPU tensor: there is no device to lose, and f32 is the only type in use.
pub fn values<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    match read(tensor) {
        Ok(values) => values,
        Err(error) => unreachable!("{error}"),
    }
}

/// A tensor on `device` from values on the host.
pub fn upload<const D: usize>(values: Vec<f32>, shape: [usize; D], device: &Device) -> Tensor<D> {
    Tensor::from_data(TensorData::new(values, shape), device)
}

/// A vector on `device`.
pub fn vector(values: &[f32], device: &Device) -> Tensor<1> {
    upload(values.to_vec(), [values.len()], device)
}

/// Numbers summed by one invocation: lavapipe's stop, silently, after 65,535.
const ROW: usize = 512;

/// The sum of a vector, `[1]`.
pub fn sum(values: Tensor<1>) -> Tensor<1> {
    column_sums(values.unsqueeze_dim(1))
}

/// The mean of a vector, `[1]`.
pub fn mean(values: Tensor<1>) -> Tensor<1> {
    let length = values.dims()[0];
    sum(values).mul_scalar(1.0 / length as f64)
}

/// The sums of the columns of `[n, width]`, in two stages: burn's own walks a long column in few
/// invocations, of which lavapipe leaves the rest out.
pub fn column_sums(values: Tensor<2>) -> Tensor<1> {
    let [length, width] = values.dims();
    let whole = length / ROW * ROW;
    if whole == 0 {
        return values.sum_dim(0).squeeze_dim(0);
    }
    let rows: Tensor<3> = values
        .clone()
        .narrow(0, 0, whole)
        .reshape([whole / ROW, ROW, width]);
    let sums = rows.sum_dim(1).sum_dim(0).reshape([width]);
    match whole == length {
        true => sums,
        false => sums.add(
            values
                .narrow(0, whole, length - whole)
                .sum_dim(0)
                .squeeze_dim(0),
        ),
    }
}

/// Writes a tensor's values into an array from the index `at` on. In place where nobody else holds the
/// array's memory.
pub fn write<const D: usize>(gpu: &Gpu, values: Tensor<D>, out: &mut Array, at: usize) {
    let buffer = std::mem::replace(out, Array::Host(Vec::new()));
    let tensor: Tensor<1> = from_buffer(gpu, buffer.buffer(), [buffer.len()]);
    drop(buffer);
    let count = values.shape().num_elements();
    let tensor = tensor.slice_assign([at..at + count], values.reshape([count]));
    *out = Array::Gpu(to_buffer(tensor));
}
