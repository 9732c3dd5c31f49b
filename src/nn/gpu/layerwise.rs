//! Networks of any layers, one after another in burn's tensors: products of matrices and convolutions, whose
//! gradients are taken by hand.

use super::dims::dims;
use super::tensors::{column_sums, write};
use crate::gpu::tensor::{from_buffer, to_buffer};
use crate::gpu::{Array, Buffer, Device, Gpu};
use crate::nn::extent::{EngineSize, Samples};
use crate::nn::layer::{Activation, Layer};
use crate::nn::network::{LayerParams, Network};
use crate::nn::objective::{GpuBatch, Objective};
use anyhow::Result;
use burn::tensor::Tensor;
use burn::tensor::activation::relu;
use burn::tensor::module::{conv_transpose2d, conv2d, conv2d_weight_backward, linear};
use burn::tensor::ops::{ConvOptions, ConvTransposeOptions};
use std::ops::Range;

/// The most numbers of what a layer makes of the rows that are evaluated at once (64 MB).
const AT_ONCE: usize = 1 << 24;

/// What the networks need on the device.
pub struct Layerwise {
    gpu: Gpu,
    networks: Vec<Network>,
    dims: Buffer<u32>,
    /// Parameters behind the networks', and all extras.
    others: usize,
    extras: usize,
}

impl Layerwise {
    /// # Errors
    /// What a minibatch needs is too large for the device.
    pub fn new(gpu: &Gpu, networks: Vec<Network>, size: EngineSize) -> Result<Self> {
        let widest = networks.iter().map(widest).max().unwrap_or(0);
        let device = Device::from(gpu.clone());
        device.holds("activations of a minibatch", size.minibatch * widest)?;
        Ok(Layerwise {
            gpu: gpu.clone(),
            dims: dims(gpu, &networks, size),
            others: size.others(&networks),
            networks,
            extras: size.extras,
        })
    }

    pub fn forward(
        &self,
        network: usize,
        parameters: &Array,
        batch: Samples,
        out: &mut Array,
        out_at: usize,
    ) {
        let network = &self.networks[network];
        let most = (AT_ONCE / widest(network)).max(1);
        let flat = self.flat(parameters);
        let part = |start: usize| {
            let batch = Samples {
                first: batch.first + start,
                count: most.min(batch.count - start),
                ..batch
            };
            Pass::new(network, &flat, self.observations(network, batch)).1
        };
        for start in (0..batch.count).step_by(most) {
            let at = out_at + start * network.outputs();
            write(&self.gpu, part(start), out, at);
        }
    }

    pub fn gradient(
        &self,
        parameters: &Array,
        batch: Samples,
        objective: &dyn Objective,
        gradient: &mut Array,
        sums: &mut Array,
    ) {
        let (gpu, count) = (&self.gpu, batch.count);
        let flat = self.flat(parameters);
        let pass = |network: &Network| Pass::new(network, &flat, self.observations(network, batch));
        let (passes, outputs): (Vec<Pass>, Vec<Tensor<2>>) = self.networks.iter().map(pass).unzip();
        let outputs = outputs.into_iter().map(|outputs| outputs.flatten(0, 1));
        let outputs = to_buffer(Tensor::<1>::cat(outputs.collect(), 0));
        let (output_grads, extras) = (
            Buffer::empty(gpu, outputs.len()),
            Buffer::empty(gpu, count * self.extras),
        );
        let buffers = GpuBatch {
            dims: &self.dims,
            samples: batch.values.buffer(),
            width: batch.width,
            first: batch.first,
            rows: count,
            parameters: parameters.buffer(),
            outputs: &outputs,
            output_grads: &output_grads,
            extras: &extras,
        };
        objective.launch(gpu, &buffers);
        let output_grads: Tensor<1> = from_buffer(gpu, &output_grads, [output_grads.len()]);
        let mut parts = Vec::new();
        let mut at = 0;
        for (network, pass) in self.networks.iter().zip(&passes) {
            let length = count * network.outputs();
            let grads = output_grads.clone().narrow(0, at, length);
            let grads = grads.reshape([count, network.outputs()]);
            at += length;
            parts.extend(pass.back(network, &flat, grads));
        }
        let extras = column_sums(from_buffer(gpu, &extras, [count, self.extras]));
        if self.others > 0 {
            parts.push(extras.clone().narrow(0, 0, self.others));
        }
        *gradient = Array::Gpu(to_buffer(Tensor::cat(parts, 0)));
        if self.extras > self.others {
            let new = extras.narrow(0, self.others, self.extras - self.others);
            let before = from_buffer(gpu, sums.buffer(), [sums.len()]);
            *sums = Array::Gpu(to_buffer(new.add(before)));
        }
    }

    /// See [`Engine::add_gradient_penalty`](crate::nn::Engine::add_gradient_penalty).
    pub fn add_gradient_penalty(
        &self,
        network: usize,
        parameters: &Array,
        batch: Samples,
        heads: usize,
        weight: f32,
        gradient: &mut Array,
        sums: &mut Array,
    ) {
        let (gpu, network) = (&self.gpu, &self.networks[network]);
        let flat = self.flat(parameters);
        let (pass, outputs) = Pass::new(network, &flat, self.observations(network, batch));
        let (own, square) = pass.penalty(network, &flat, outputs, heads, weight);
        let sum = self.flat(gradient);
        let sum = part(&sum, network.span()).add(Tensor::cat(own, 0));
        write(gpu, sum, gradient, network.span().start);
        let sum = self.flat(sums);
        write(gpu, sum.narrow(0, 0, 1).add(square), sums, 0);
    }

    fn flat(&self, parameters: &Array) -> Tensor<1> {
        from_buffer(&self.gpu, parameters.buffer(), [parameters.len()])
    }

    /// `[rows, observation]`
    fn observations(&self, network: &Network, batch: Samples) -> Tensor<2> {
        let height = batch.values.len() / batch.width;
        let all: Tensor<2> = from_buffer(&self.gpu, batch.values.buffer(), [height, batch.width]);
        let observation = network.observation().dim();
        all.slice([batch.first..batch.first + batch.count, 0..observation])
    }
}

/// The most numbers that come out of a layer or go into one, for one row.
fn widest(network: &Network) -> usize {
    let lens = network.layers().iter();
    let lens = lens.flat_map(|params| [params.layer.input_len(), params.layer.output_len()]);
    lens.max().unwrap_or(1).max(network.observation().dim())
}

/// What a batch left on its way through a network.
struct Pass {
    /// Activations of every layer, `[rows, ..]`.
    inputs: Vec<Tensor<2>>,
}

impl Pass {
    /// Takes observations through a network. Returns the outputs, too.
    fn new(network: &Network, flat: &Tensor<1>, observation: Tensor<2>) -> (Pass, Tensor<2>) {
        let (encoder, vector) = (network.encoder_len(), network.observation().vector);
        let maps = network.observation().dim() - vector;
        let mut values = match encoder > 0 {
            true => observation.clone().narrow(1, vector, maps),
            false => observation.clone(),
        };
        let mut inputs = Vec::with_capacity(network.layers().len());
        for (number, params) in network.layers().iter().enumerate() {
            if number == encoder && encoder > 0 {
                let vector = observation.clone().narrow(1, 0, vector);
                values = Tensor::cat(vec![vector, values], 1);
            }
            inputs.push(values.clone());
            values = forward(params, flat, values);
        }
        (Pass { inputs }, values)
    }

    /// The gradients, in the order of the parameters, of `weight` times the mean squared norm of the
    /// gradient of the mean of the heads with respect to the observation; and the sum of these squared norms.
    fn penalty(
        &self,
        network: &Network,
        flat: &Tensor<1>,
        outputs: Tensor<2>,
        heads: usize,
        weight: f32,
    ) -> (Vec<Tensor<1>>, Tensor<1>) {
        let [rows, width] = outputs.dims();
        let seed = outputs.narrow(1, 0, heads).zeros_like();
        let mut seed = vec![seed.add_scalar(1.0 / heads as f32)];
        if width > heads {
            seed.push(Tensor::zeros([rows, width - heads], &seed[0].device()));
        }
        let mut backward = vec![Tensor::cat(seed, 1)];
        for (number, params) in network.layers().iter().enumerate().rev() {
            let mut next = input_gradient(params, flat, backward[backward.len() - 1].clone());
            if let Some(below) = number.checked_sub(1) {
                let kind = network.layers()[below].layer.activation();
                next = activation_backward(kind, next, self.inputs[number].clone());
            }
            backward.push(next);
        }
        // Of the observation first, then of the sums of every layer.
        backward.reverse();
        let square = column_sums(backward[0].clone().square().sum_dim(1));
        let mut forward = backward[0].clone().mul_scalar(2.0 * weight / rows as f32);
        let mut parts = Vec::new();
        for (number, params) in network.layers().iter().enumerate() {
            let own = forward
                .clone()
                .transpose()
                .matmul(backward[number + 1].clone());
            parts.push(own.flatten(0, 1));
            parts.push(part(flat, params.biases()).zeros_like());
            if let Some(activations) = self.inputs.get(number + 1) {
                forward = forward.matmul(weights(params, flat));
                let kind = params.layer.activation();
                forward = activation_backward(kind, forward, activations.clone());
            }
        }
        (parts, square)
    }

    /// The gradients of all parameters in their order, given that of the outputs.
    fn back(&self, network: &Network, flat: &Tensor<1>, gradient: Tensor<2>) -> Vec<Tensor<1>> {
        let mut parts = Vec::new();
        let mut gradient = gradient;
        for (number, params) in network.layers().iter().enumerate().rev() {
            let input = &self.inputs[number];
            parts.push(bias_gradient(&params.layer, gradient.clone()));
            parts.push(weight_gradient(params, flat, input, &gradient));
            let Some(below) = number.checked_sub(1) else {
                break;
            };
            gradient = input_gradient(params, flat, gradient);
            let mut activations = input.clone();
            if number == network.encoder_len() {
                // The vector joined here; it does not learn.
                let vector = network.observation().vector;
                let after = |values: Tensor<2>| {
                    let width = values.dims()[1] - vector;
                    values.narrow(1, vector, width)
                };
                (gradient, activations) = (after(gradient), after(activations));
            }
            let kind = network.layers()[below].layer.activation();
            gradient = activation_backward(kind, gradient, activations);
        }
        parts.reverse();
        parts
    }
}

fn activation(kind: Activation, sums: Tensor<2>) -> Tensor<2> {
    match kind {
        Activation::Relu => relu(sums),
        Activation::Tanh => sums.tanh(),
        Activation::Identity => sums,
    }
}

/// The gradient with respect to sums from that with respect to the `activations` they became.
fn activation_backward(kind: Activation, gradient: Tensor<2>, activations: Tensor<2>) -> Tensor<2> {
    match kind {
        Activation::Relu => gradient.mul(activations.sign()),
        Activation::Tanh => gradient.mul(activations.square().neg().add_scalar(1.0)),
        Activation::Identity => gradient,
    }
}

/// Outputs `[rows, height * width * filters]` from inputs `[rows, height * width * channels]`.
fn forward(params: &LayerParams, flat: &Tensor<1>, input: Tensor<2>) -> Tensor<2> {
    let layer = &params.layer;
    let biases = Some(part(flat, params.biases()));
    let sums = match layer.is_dense() {
        true => linear(input, weights(params, flat), biases),
        false => {
            let images = images(input, layer.inputs());
            images_to_rows(conv2d(
                images,
                filters(params, flat),
                biases,
                options(layer),
            ))
        }
    };
    activation(layer.activation(), sums)
}

fn bias_gradient(layer: &Layer, gradient: Tensor<2>) -> Tensor<1> {
    let [rows, width] = gradient.dims();
    let pixels = width / layer.filters();
    column_sums(gradient.reshape([rows * pixels, layer.filters()]))
}

fn weight_gradient(
    params: &LayerParams,
    flat: &Tensor<1>,
    input: &Tensor<2>,
    gradient: &Tensor<2>,
) -> Tensor<1> {
    let layer = &params.layer;
    if layer.is_dense() {
        let product = input.clone().transpose().matmul(gradient.clone());
        return product.flatten(0, 1);
    }
    let input = images(input.clone(), layer.inputs());
    let gradient = images(gradient.clone(), layer.outputs());
    let filters = filters(params, flat);
    let gradient = conv2d_weight_backward(input, filters, gradient, options(layer));
    gradient.permute([2, 3, 1, 0]).flatten(0, 3)
}

fn input_gradient(params: &LayerParams, flat: &Tensor<1>, gradient: Tensor<2>) -> Tensor<2> {
    let layer = &params.layer;
    if layer.is_dense() {
        return gradient.matmul(weights(params, flat).transpose());
    }
    // Cells of the input that no filter reaches.
    let [height, width, _] = layer.inputs();
    let [rows, columns, _] = layer.outputs();
    let over = |cells: usize, places: usize| cells - (places - 1) * layer.stride() - layer.size();
    let over = [over(height, rows), over(width, columns)];
    let options = ConvTransposeOptions::new([layer.stride(); 2], [0; 2], over, [1; 2], 1);
    let gradient = images(gradient, layer.outputs());
    images_to_rows(conv_transpose2d(
        gradient,
        filters(params, flat),
        None,
        options,
    ))
}

fn part(flat: &Tensor<1>, range: Range<usize>) -> Tensor<1> {
    flat.clone().slice([range])
}

/// `[patch, filters]`
fn weights(params: &LayerParams, flat: &Tensor<1>) -> Tensor<2> {
    part(flat, params.weights()).reshape([params.layer.patch(), params.layer.filters()])
}

/// `[filters, channels, size, size]`
fn filters(params: &LayerParams, flat: &Tensor<1>) -> Tensor<4> {
    let (size, channels) = (params.layer.size(), params.layer.inputs()[2]);
    let weights = part(flat, params.weights());
    let weights: Tensor<4> = weights.reshape([size, size, channels, params.layer.filters()]);
    weights.permute([3, 2, 0, 1])
}

fn options(layer: &Layer) -> ConvOptions<2> {
    ConvOptions::new([layer.stride(); 2], [0; 2], [1; 2], 1)
}

/// `[rows, channels, height, width]` from rows with the channels last.
fn images(rows: Tensor<2>, [height, width, channels]: [usize; 3]) -> Tensor<4> {
    let samples = rows.dims()[0];
    let images: Tensor<4> = rows.reshape([samples, height, width, channels]);
    images.permute([0, 3, 1, 2])
}

/// The opposite of [`images`].
fn images_to_rows(images: Tensor<4>) -> Tensor<2> {
    let [samples, channels, height, width] = images.dims();
    let images = images.permute([0, 2, 3, 1]);
    images.reshape([samples, height * width * channels])
}
