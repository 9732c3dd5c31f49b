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
