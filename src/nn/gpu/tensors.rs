//! Operations on tensors that burn has not, or not for devices like lavapipe.

use crate::gpu::tensor::{from_buffer, to_buffer};
use crate::gpu::{Array, Gpu};
use burn::tensor::Tensor;
use std::ops::Range;

/// Numbers summed by one invocation: lavapipe's stop, silently, after 65,535.
const ROW: usize = 512;

/// The sums of the columns of `[n, width]`, in two stages: burn's own walks a long column in few
/// invocations, of which lavapipe leaves the rest out.
pub fn column_sums(values: Tensor<2>) -> Tensor<1> {
    let [length, width] = values.dims();
    let (whole, rest) = (length / ROW * ROW, length % ROW);
    if whole == 0 {
        return values.sum_dim(0).reshape([width]);
    }
    let stages: Tensor<3> = values
        .clone()
        .narrow(0, 0, whole)
        .reshape([whole / ROW, ROW, width]);
    let sums = stages.sum_dim(1).sum_dim(0).reshape([width]);
    match rest {
        0 => sums,
        _ => sums.add(values.narrow(0, whole, rest).sum_dim(0).reshape([width])),
    }
}

/// Writes a tensor's values into an array from the index `at` on. In place where nobody else holds the
/// array's memory.
#[expect(clippy::single_range_in_vec_init, reason = "a range of one dimension")]
pub fn write<const D: usize>(gpu: &Gpu, values: Tensor<D>, out: &mut Array, at: usize) {
    let buffer = std::mem::replace(out, Array::Host(Vec::new()));
    let tensor: Tensor<1> = from_buffer(gpu, buffer.buffer(), [buffer.len()]);
    drop(buffer);
    let count = values.shape().num_elements();
    let tensor = tensor.slice_assign([at..at + count], values.reshape([count]));
    *out = Array::Gpu(to_buffer(tensor));
}

fn all(gpu: &Gpu, values: &Array) -> Tensor<1> {
    from_buffer(gpu, values.buffer(), [values.len()])
}

fn rows(gpu: &Gpu, values: &Array, width: usize) -> Tensor<2> {
    from_buffer(gpu, values.buffer(), [values.len() / width, width])
}

/// See [`crate::nn::rows::beside`].
pub fn beside(gpu: &Gpu, parts: &[(&Array, usize)]) -> Array {
    let parts = parts.iter().map(|(part, width)| rows(gpu, part, *width));
    let whole = Tensor::cat(parts.collect(), 1);
    Array::Gpu(to_buffer(whole.flatten::<1>(0, 1)))
}

/// See [`crate::nn::rows::columns`].
pub fn columns(gpu: &Gpu, from: &Array, width: usize, range: Range<usize>) -> Array {
    let part = rows(gpu, from, width).narrow(1, range.start, range.len());
    Array::Gpu(to_buffer(part.flatten::<1>(0, 1)))
}

/// See [`crate::nn::rows::join`].
pub fn join(gpu: &Gpu, parts: &[&Array]) -> Array {
    let parts = parts.iter().map(|part| all(gpu, part)).collect();
    Array::Gpu(to_buffer(Tensor::<1>::cat(parts, 0)))
}

/// See [`crate::nn::rows::replace`].
pub fn replace(gpu: &Gpu, to: &mut Array, at: usize, values: &Array) {
    write(gpu, all(gpu, values), to, at);
}

/// See [`crate::nn::rows::add_sum`].
pub fn add_sum(gpu: &Gpu, values: &Array, to: &mut Array) {
    let sum = column_sums(rows(gpu, values, 1)).add(all(gpu, to).narrow(0, 0, 1));
    write(gpu, sum, to, 0);
}

/// See [`crate::nn::rows::add_scaled`].
pub fn add_scaled(gpu: &Gpu, values: &Array, range: Range<usize>, factor: f32, to: &mut Array) {
    let part = |values: &Array| all(gpu, values).slice([range.clone()]);
    let sum = part(to).add(part(values).mul_scalar(factor));
    write(gpu, sum, to, range.start);
}
