//! Between tensors and plain arrays on the host.

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

/// The sum of a vector, `[1]`, in two stages. burn's own walks a long vector in few invocations, of
/// which lavapipe leaves the rest out.
pub fn sum(values: Tensor<1>) -> Tensor<1> {
    let length = values.dims()[0];
    let whole = length / ROW * ROW;
    if whole == 0 {
        return values.sum_dim(0);
    }
    let rows: Tensor<2> = values
        .clone()
        .narrow(0, 0, whole)
        .reshape([whole / ROW, ROW]);
    let sum = rows.sum_dim(1).sum_dim(0).squeeze_dim(1);
    match whole == length {
        true => sum,
        false => sum.add(values.narrow(0, whole, length - whole).sum_dim(0)),
    }
}

/// The mean of a vector, `[1]`.
pub fn mean(values: Tensor<1>) -> Tensor<1> {
    let length = values.dims()[0];
    sum(values).mul_scalar(1.0 / length as f64)
}
