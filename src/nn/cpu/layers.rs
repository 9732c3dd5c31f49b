//! A layer for some rows on one core: forward, and the gradients backward.

use super::matmul::{Matrix, add_product};
use super::microkernel::{Forward, InputGradient, WeightGradient, microkernel};
use super::tanh::tanh;
use crate::nn::layer::{Activation, Layer};
use crate::nn::network::LayerParams;

/// Dense layers with at least so many inputs and outputs are products of matrices; what is narrower fits
/// the registers.
const WIDE: usize = 96;

/// Whether a layer is computed as a product of matrices.
pub fn is_wide(layer: &Layer) -> bool {
    layer.is_dense() && layer.patch().min(layer.filters()) >= WIDE
}

/// Puts outputs `[rows][height][width][filters]` in the place of `output`, from inputs `[rows][height][width][channels]`.
/// `offsets` is memory for those of the patches.
pub fn forward(
    params: &LayerParams,
    flat: &[f32],
    input: &[f32],
    rows: usize,
    offsets: &mut Vec<usize>,
    output: &mut Vec<f32>,
) {
    let layer = &params.layer;
    let (weights, biases) = (&flat[params.weights()], &flat[params.biases()]);
    output.clear();
    if is_wide(layer) {
        (0..rows).for_each(|_| output.extend_from_slice(biases));
        add_product(
            output,
            Matrix::rows(input, layer.patch()),
            Matrix::rows(weights, layer.filters()),
        );
        if layer.activation() == Activation::Relu {
            output.iter_mut().for_each(|sum| *sum = sum.max(0.0));
        }
    } else {
        layer.patch_offsets_into(rows, offsets);
        output.resize(rows * layer.output_len(), 0.0);
        let mut kernel = Forward {
            patch_offsets: offsets,
            patch_row_len: layer.patch_row_len(),
            row_stride: layer.row_stride(),
            input,
            weights,
            biases,
            least: match layer.activation() {
                Activation::Relu => 0.0,
                Activation::Tanh | Activation::Identity => f32::NEG_INFINITY,
            },
            output,
        };
        microkernel(&mut kernel, offsets.len(), layer.filters());
    }
    if layer.activation() == Activation::Tanh {
        tanh(output);
    }
}

/// Makes the gradient with respect to sums from that with respect to the `activations` they became.
pub fn activation_backward(kind: Activation, gradient: &mut [f32], activations: &[f32]) {
    let pairs = gradient.iter_mut().zip(activations);
    match kind {
        Activation::Relu => {
            pairs.for_each(|(gradient, &a)| *gradient = if a > 0.0 { *gradient } else { 0.0 });
        }
        Activation::Tanh => pairs.for_each(|(gradient, &a)| *gradient *= 1.0 - a * a),
        Activation::Identity => {}
    }
}

/// The weights of a narrow layer as `[size][filters][patch row]`; none of a wide one.
pub fn transpose(params: &LayerParams, flat: &[f32]) -> Vec<f32> {
    let (length, filters) = (params.layer.patch_row_len(), params.layer.filters());
    if is_wide(&params.layer) {
        return Vec::new();
    }
    let weights = &flat[params.weights()];
    let mut transposed = vec![0.0; weights.len()];
    let rows = weights.chunks_exact(length * filters);
    for (row, out) in rows.zip(transposed.chunks_exact_mut(length * filters)) {
        for (i, weights) in row.chunks_exact(filters).enumerate() {
            for (filter, &weight) in weights.iter().enumerate() {
                out[filter * length + i] = weight;
            }
        }
    }
    transposed
}

/// Adds the gradients of a narrow layer's weights and biases to `sums`, given those of its sums.
pub fn add_gradient(layer: &Layer, input: &[f32], gradient: &[f32], sums: &mut [f32]) {
    let (length, filters) = (layer.patch_row_len(), layer.filters());
    let offsets = layer.patch_offsets(gradient.len() / layer.output_len());
    let (weights, biases) = sums.split_at_mut(layer.patch() * filters);
    for (y, output) in weights.chunks_exact_mut(length * filters).enumerate() {
        let mut kernel = WeightGradient {
            patch_offsets: &offsets,
            filters,
            input: &input[y * layer.row_stride()..],
            gradient,
            output,
        };
        microkernel(&mut kernel, length, filters);
    }
    add_columns(gradient, biases);
}

/// Adds the gradients of some rows of a wide layer's weights, the inputs from `first` on, to `sums`.
/// Behind the last weights stand the biases.
pub fn add_wide_gradient(
    layer: &Layer,
    first: usize,
    input: &[f32],
    gradient: &[f32],
    sums: &mut [f32],
) {
    let inputs = (layer.patch() - first).min(sums.len() / layer.filters());
    let (weights, biases) = sums.split_at_mut(inputs * layer.filters());
    if inputs > 0 {
        let inputs = Matrix::rows(input, layer.patch()).columns(first, inputs);
        add_product(
            weights,
            inputs.transposed(),
            Matrix::rows(gradient, layer.filters()),
        );
    }
    if !biases.is_empty() {
        add_columns(gradient, biases);
    }
}

/// A bias is the weight of an input that is always one.
fn add_columns(rows: &[f32], sums: &mut [f32]) {
    for row in rows.chunks_exact(sums.len()) {
        for (sum, value) in sums.iter_mut().zip(row) {
            *sum += value;
        }
    }
}

/// The gradient with respect to a layer's input, of `length` numbers, given that of its sums. `transposed`
/// are the weights as [`transpose`] leaves them.
pub fn input_gradient(
    params: &LayerParams,
    flat: &[f32],
    transposed: &[f32],
    gradient: &[f32],
    length: usize,
) -> Vec<f32> {
    let layer = &params.layer;
    let (patch_row_len, filters) = (layer.patch_row_len(), layer.filters());
    let mut output = vec![0.0; length];
    if is_wide(layer) {
        let weights = Matrix::rows(&flat[params.weights()], filters);
        add_product(
            &mut output,
            Matrix::rows(gradient, filters),
            weights.transposed(),
        );
        return output;
    }
    let offsets = layer.patch_offsets(gradient.len() / layer.output_len());
    for (y, weights) in transposed.chunks_exact(patch_row_len * filters).enumerate() {
        let mut kernel = InputGradient {
            patch_offsets: &offsets,
            patch_row_len,
            filters,
            weights,
            gradient,
            output: &mut output[y * layer.row_stride()..],
        };
        microkernel(&mut kernel, offsets.len(), patch_row_len);
    }
    output
}
