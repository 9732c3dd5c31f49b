//! The penalty on a network's gradient with respect to its observation.
//!
//! Where all hidden layers are ReLUs, the gradient g with respect to the observation is a product of weights
//! and masks. The gradient of |g|^2 with respect to a layer's weights is then the outer product of two
//! vectors: 2 g taken forward to the layer's input through weights and masks, and the output's gradient taken
//! back to the layer's sums.

use super::layers;
use super::matmul::{Matrix, add_product};
use super::{CpuEngine, Pass, add};
use crate::gpu::Array;
use crate::nn::extent::Samples;
use crate::nn::network::Network;
use rayon::prelude::*;

/// Rows taken through the network together, each such part with a gradient of its own.
const PART_ROWS: usize = 128;

impl CpuEngine {
    /// See [`Engine::add_gradient_penalty`](crate::nn::Engine::add_gradient_penalty).
    pub fn add_gradient_penalty(
        &self,
        network: usize,
        parameters: &Array,
        samples: Samples,
        heads: usize,
        weight: f32,
        gradient: &mut [f32],
        sums: &mut [f32],
    ) {
        let (network, flat) = (&self.networks[network], parameters.host());
        let Samples { width, count, .. } = samples;
        let values = &samples.values.host()[samples.first * width..][..count * width];
        let factor = 2.0 * weight / count as f32;
        let transposed: Vec<Vec<f32>> = network
            .layers()
            .iter()
            .map(|params| layers::transpose(params, flat))
            .collect();
        let parts = values.par_chunks(PART_ROWS * width).map(|values| {
            let rows: Vec<&[f32]> = values.chunks_exact(width).collect();
            let mut gradient = vec![0.0; network.span().len()];
            let square = penalty(
                network,
                flat,
                &transposed,
                &rows,
                heads,
                factor,
                &mut gradient,
            );
            (gradient, square)
        });
        let parts: Vec<(Vec<f32>, f32)> = parts.collect();
        let gradient = &mut gradient[network.span()];
        for (own, square) in parts {
            add(gradient, &own);
            sums[0] += square;
        }
    }
}

/// Adds the gradient of half of `factor` times the sum of the squared norms to `gradient`. Returns that sum.
fn penalty(
    network: &Network,
    flat: &[f32],
    transposed: &[Vec<f32>],
    rows: &[&[f32]],
    heads: usize,
    factor: f32,
    gradient: &mut [f32],
) -> f32 {
    let mut pass = Pass::default();
    pass.forward(network, flat, rows);
    let backward = back(network, flat, transposed, &pass, heads);
    let slope = &backward[0];
    let square = slope.iter().map(|value| value * value).sum();
    let mut forward: Vec<f32> = slope.iter().map(|value| factor * value).collect();
    let start = network.span().start;
    for (number, params) in network.layers().iter().enumerate() {
        let (inputs, outputs) = (params.layer.patch(), params.layer.filters());
        let weights = params.weights();
        add_product(
            &mut gradient[weights.start - start..weights.end - start],
            Matrix::rows(&forward, inputs).transposed(),
            Matrix::rows(&backward[number + 1], outputs),
        );
        if number + 1 < network.layers().len() {
            let mut next = vec![0.0; rows.len() * outputs];
            add_product(
                &mut next,
                Matrix::rows(&forward, inputs),
                Matrix::rows(&flat[weights], outputs),
            );
            let kind = params.layer.activation();
            layers::activation_backward(kind, &mut next, &pass.inputs[number + 1]);
            forward = next;
        }
    }
    square
}

/// The gradient of the mean of the heads with respect to the observation, then to the sums of every layer.
fn back(
    network: &Network,
    flat: &[f32],
    transposed: &[Vec<f32>],
    pass: &Pass,
    heads: usize,
) -> Vec<Vec<f32>> {
    let layers = network.layers();
    let mut seed = vec![0.0; network.outputs()];
    seed[..heads].fill(1.0 / heads as f32);
    let mut backward = vec![seed.repeat(pass.rows)];
    for (number, params) in layers.iter().enumerate().rev() {
        let (above, input) = (&backward[backward.len() - 1], &pass.inputs[number]);
        let mut next =
            layers::input_gradient(params, flat, &transposed[number], above, input.len());
        if let Some(below) = number.checked_sub(1) {
            let kind = layers[below].layer.activation();
            layers::activation_backward(kind, &mut next, input);
        }
        backward.push(next);
    }
    backward.reverse();
    backward
}
