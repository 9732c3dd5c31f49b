//! Operations on tensors that burn has not, or not for devices like lavapipe.

use crate::gpu::tensor::{from_buffer, to_buffer};
use crate::gpu::{Array, Gpu};
use burn::tensor::Tensor;

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
