//! A chunk of samples through layers after each other, and back, on one core.

use super::kernels::{Forward, InputGradient, WeightGradient, tile};
use super::tanh::tanh;
use crate::nn::layer::{Bend, Layer, floats};
use crate::nn::network::Place;

/// Activations of every layer, `[samples][height][width][filters]`, from `input`,
/// `[samples][height][width][channels]`.
pub fn forward(places: &[Place], flat: &[f32], input: &[f32], samples: usize) -> Vec<Vec<f32>> {
    let mut activations: Vec<Vec<f32>> = Vec::with_capacity(places.len());
    for place in places {
        let input = activations.last().map_or(input, |below| below);
        let mut output = vec![0.0; samples * floats(place.layer.outputs())];
        let parameters = (&flat[place.weights()], &flat[place.biases()]);
        activate(&place.layer, parameters, input, &mut output, samples);
        activations.push(output);
    }
    activations
}

fn activate(
    layer: &Layer,
    (weights, biases): (&[f32], &[f32]),
    input: &[f32],
    output: &mut [f32],
    samples: usize,
) {
    let starts = layer.starts(samples);
    let mut kernel = Forward {
        starts: &starts,
        run: layer.run(),
        pitch: layer.pitch(),
        input,
        weights,
        biases,
        least: match layer.bend() {
            Bend::Relu => 0.0,
            Bend::Tanh | Bend::None => f32::NEG_INFINITY,
        },
        output,
    };
    tile(&mut kernel, starts.len(), layer.filters());
    if layer.bend() == Bend::Tanh {
        tanh(output);
    }
}

/// Adds the gradients of every layer's parameters to `sums`, which begins with the parameter `first`
/// of the flat vector; from the weights as [`transpose`] leaves them, the input and activations as in
/// [`forward`], and the `gradient` with respect to the last activations. The activations of the last
/// layer may be missing if it does not bend. Returns the gradient with respect to the input, if it is
/// `wanted`.
pub fn backward(
    (places, transposed): (&[Place], &[Vec<f32>]),
    (input, activations): (&[f32], &[Vec<f32>]),
    mut gradient: Vec<f32>,
    wanted: bool,
    (sums, first): (&mut [f32], usize),
) -> Vec<f32> {
    for (i, place) in places.iter().enumerate().rev() {
        let layer = &place.layer;
        if let Some(activations) = activations.get(i) {
            unbend(layer.bend(), &mut gradient, activations);
        }
        let starts = layer.starts(gradient.len() / floats(layer.outputs()));
        let input = i.checked_sub(1).map_or(input, |below| &activations[below]);
        let [weights, biases] =
            [place.weights(), place.biases()].map(|range| range.start - first..range.end - first);
        weight_gradient(layer, &starts, input, &gradient, &mut sums[weights]);
        bias_gradient(layer, &gradient, &mut sums[biases]);
        if i > 0 || wanted {
            gradient = input_gradient(layer, &starts, &transposed[i], &gradient, input.len());
        }
    }
    gradient
}

/// The gradient before the bend from that after it.
fn unbend(bend: Bend, gradient: &mut [f32], activations: &[f32]) {
    let pairs = gradient.iter_mut().zip(activations);
    match bend {
        Bend::Relu => {
            pairs.for_each(|(gradient, &a)| *gradient = if a > 0.0 { *gradient } else { 0.0 })
        }
        Bend::Tanh => pairs.for_each(|(gradient, &a)| *gradient *= 1.0 - a * a),
        Bend::None => {}
    }
}

/// Weights `[size][filters][run]`.
pub fn transpose(layer: &Layer, weights: &[f32]) -> Vec<f32> {
    let (run, filters) = (layer.run(), layer.filters());
    let mut transposed = vec![0.0; weights.len()];
    let rows = weights.chunks_exact(run * filters);
    for (row, out) in rows.zip(transposed.chunks_exact_mut(run * filters)) {
        for (i, weights) in row.chunks_exact(filters).enumerate() {
            for (filter, &weight) in weights.iter().enumerate() {
                out[filter * run + i] = weight;
            }
        }
    }
    transposed
}

fn weight_gradient(
    layer: &Layer,
    starts: &[usize],
    input: &[f32],
    gradient: &[f32],
    sums: &mut [f32],
) {
    let (run, filters) = (layer.run(), layer.filters());
    for (y, output) in sums.chunks_exact_mut(run * filters).enumerate() {
        let mut kernel = WeightGradient {
            starts,
            filters,
            input: &input[y * layer.pitch()..],
            gradient,
            output,
        };
        tile(&mut kernel, run, filters);
    }
}

/// A bias is the weight of an input that is always one.
fn bias_gradient(layer: &Layer, gradient: &[f32], sums: &mut [f32]) {
    for gradient in gradient.chunks_exact(layer.filters()) {
        for (sum, gradient) in sums.iter_mut().zip(gradient) {
            *sum += gradient;
        }
    }
}

/// The gradient with respect to a layer's input, of `length` floats.
fn input_gradient(
    layer: &Layer,
    starts: &[usize],
    transposed: &[f32],
    gradient: &[f32],
    length: usize,
) -> Vec<f32> {
    let (run, filters) = (layer.run(), layer.filters());
    let mut output = vec![0.0; length];
    for (y, weights) in transposed.chunks_exact(run * filters).enumerate() {
        let mut kernel = InputGradient {
            starts,
            run,
            filters,
            weights,
            gradient,
            output: &mut output[y * layer.pitch()..],
        };
        tile(&mut kernel, starts.len(), run);
    }
    output
}
