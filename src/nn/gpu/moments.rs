//! Running moments in tensors: see [`RunningMeanStd`](crate::nn::RunningMeanStd).

use super::tensors::column_sums;
use crate::gpu::tensor::{from_buffer, to_buffer};
use crate::gpu::{Array, Gpu};
use burn::tensor::Tensor;

/// Mixes the moments of so many rows in, at a `weight` of their part of all rows.
pub fn take_in(gpu: &Gpu, moments: &mut Array, values: &Array, rows: usize, weight: f64) {
    let [means, variances] = halves(gpu, moments);
    let difference = rows_of(gpu, values, 0, rows, means.dims()[1]).sub(means.clone());
    let mean = |values: Tensor<2>| -> Tensor<2> {
        let mean = column_sums(values).mul_scalar(1.0 / rows as f64);
        mean.unsqueeze()
    };
    let shift = mean(difference.clone());
    let shift_square = shift.clone().square();
    let variance = mean(difference.square()).sub(shift_square.clone());
    let mixed = variances
        .mul_scalar(1.0 - weight)
        .add(variance.mul_scalar(weight))
        .add(shift_square.mul_scalar(weight * (1.0 - weight)));
    let means = means.add(shift.mul_scalar(weight));
    let both = Tensor::cat(vec![means, mixed.clamp_min(0.0)], 0);
    *moments = Array::Gpu(to_buffer(both));
}

/// Normalised rows `[rows, dim]`, with a least standard deviation and a largest magnitude.
pub fn normalized(
    gpu: &Gpu,
    moments: &Array,
    values: &Array,
    at: usize,
    rows: usize,
    [min_std, clip]: [f32; 2],
) -> Tensor<2> {
    let [means, variances] = halves(gpu, moments);
    let std = variances.sqrt().clamp_min(min_std);
    let values = rows_of(gpu, values, at, rows, means.dims()[1]);
    values.sub(means).div(std).clamp(-clip, clip)
}

/// Means and variances, `[1, dim]` each.
fn halves(gpu: &Gpu, moments: &Array) -> [Tensor<2>; 2] {
    let dim = moments.len() / 2;
    let moments: Tensor<2> = from_buffer(gpu, moments.buffer(), [2, dim]);
    [0, 1].map(|half| moments.clone().narrow(0, half, 1))
}

fn rows_of(gpu: &Gpu, values: &Array, at: usize, rows: usize, dim: usize) -> Tensor<2> {
    let all: Tensor<1> = from_buffer(gpu, values.buffer(), [values.len()]);
    all.narrow(0, at, rows * dim).reshape([rows, dim])
}
