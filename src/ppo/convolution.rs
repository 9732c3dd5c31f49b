//! Small valid convolutions on the CPU, with their gradients: channels last, ReLU after each.
//!
//! A network's [`Layer`]s come from [`chain`]; [`forward`] gives their activations, [`backward`]
//! the gradients of their parameters. Chunks of samples are spread over the cores. They do not
//! depend on how many there are and are summed in their order: nor do the results, bit for bit.

mod kernels;

use kernels::{Forward, InputGradient, WeightGradient, tile};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Samples taken through a layer together: their activations stay in a core's cache.
const CHUNK: usize = 16;
/// Most partial sums of gradients held.
const TASKS: usize = 64;

/// What a layer of the network is asked to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Convolution {
    pub filters: usize,
    /// Height and width of a filter.
    pub size: usize,
    pub stride: usize,
}

/// A convolution of inputs of a known shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layer {
    inputs: [usize; 3],
    outputs: [usize; 3],
    convolution: Convolution,
}

/// Of a layer: weights `[size][size][channels][filters]` and biases `[filters]`.
pub type Parameters<'a> = (&'a [f32], &'a [f32]);
/// With respect to [`Parameters`], in the same layout.
pub type Gradients = (Vec<f32>, Vec<f32>);

/// Convolutions after each other, the first of inputs `[height, width, channels]`. None if a
/// filter is larger than its input, or anything is zero.
pub fn chain(inputs: [usize; 3], convolutions: &[Convolution]) -> Option<Vec<Layer>> {
    let mut inputs = inputs;
    let layers = convolutions.iter().map(|&convolution| {
        let layer = Layer::new(inputs, convolution)?;
        inputs = layer.outputs;
        Some(layer)
    });
    layers.collect()
}

impl Layer {
    /// None as with [`chain`].
    pub fn new(inputs: [usize; 3], convolution: Convolution) -> Option<Self> {
        let Convolution {
            filters,
            size,
            stride,
        } = convolution;
        let [height, width, channels] = inputs;
        if [filters, size, stride, channels].contains(&0) || size > height.min(width) {
            return None;
        }
        let places = |length: usize| (length - size) / stride + 1;
        Some(Layer {
            inputs,
            outputs: [places(height), places(width), filters],
            convolution,
        })
    }

    /// `[height, width, channels]`.
    pub fn inputs(&self) -> [usize; 3] {
        self.inputs
    }

    /// `[height, width, filters]`.
    pub fn outputs(&self) -> [usize; 3] {
        self.outputs
    }

    pub fn convolution(&self) -> Convolution {
        self.convolution
    }

    /// How many.
    pub fn weights(&self) -> usize {
        self.convolution.size * self.run() * self.filters()
    }

    /// As many biases.
    pub fn filters(&self) -> usize {
        self.convolution.filters
    }

    /// Floats of a row of a patch. With channels last they are neighbours.
    fn run(&self) -> usize {
        self.convolution.size * self.inputs[2]
    }

    /// Floats of a row of the input.
    fn pitch(&self) -> usize {
        self.inputs[1] * self.inputs[2]
    }

    /// How many samples `input` holds.
    fn samples(&self, input: &[f32]) -> usize {
        input.len() / floats(self.inputs)
    }

    /// Where in the input the patch of every output pixel starts: `[samples][height][width]`.
    fn starts(&self, samples: usize) -> Vec<usize> {
        let [rows, columns, _] = self.outputs;
        let stride = self.convolution.stride;
        let mut starts = Vec::with_capacity(samples * rows * columns);
        for sample in 0..samples {
            for row in 0..rows {
                let first = sample * floats(self.inputs) + row * stride * self.pitch();
                starts.extend((0..columns).map(|column| first + column * stride * self.inputs[2]));
            }
        }
        starts
    }
}

fn floats(shape: [usize; 3]) -> usize {
    shape.iter().product()
}

/// Activations of every layer, `[samples][height][width][filters]`, after ReLU; from `input`,
/// `[samples][height][width][channels]`.
pub fn forward(layers: &[Layer], parameters: &[Parameters], input: &[f32]) -> Vec<Vec<f32>> {
    let mut activations: Vec<Vec<f32>> = Vec::with_capacity(layers.len());
    for (layer, &parameters) in layers.iter().zip(parameters) {
        let input = activations.last().map_or(input, |below| below);
        activations.push(activate(layer, parameters, input));
    }
    activations
}

fn activate(layer: &Layer, (weights, biases): Parameters, input: &[f32]) -> Vec<f32> {
    let mut output = vec![0.0; layer.samples(input) * floats(layer.outputs)];
    let inputs = input.par_chunks(CHUNK * floats(layer.inputs));
    let outputs = output.par_chunks_mut(CHUNK * floats(layer.outputs));
    inputs.zip(outputs).for_each(|(input, output)| {
        let starts = layer.starts(layer.samples(input));
        let mut kernel = Forward {
            starts: &starts,
            run: layer.run(),
            pitch: layer.pitch(),
            input,
            weights,
            biases,
            output,
        };
        tile(&mut kernel, starts.len(), layer.filters());
    });
    output
}

/// Gradients of every layer's parameters, from what [`forward`] was given and gave, and the
/// `gradient` with respect to the last activations.
pub fn backward(
    layers: &[Layer],
    parameters: &[Parameters],
    input: &[f32],
    activations: &[Vec<f32>],
    gradient: &[f32],
) -> Vec<Gradients> {
    let samples = layers.first().map_or(0, |first| first.samples(input));
    let transposed: Vec<_> = layers
        .iter()
        .zip(parameters)
        .map(|(layer, (weights, _))| transpose(layer, weights))
        .collect();
    let batch = Batch {
        layers,
        transposed: &transposed,
        input,
        activations,
        gradient,
        samples,
    };
    let task = samples.div_ceil(TASKS).next_multiple_of(CHUNK);
    let parts: Vec<_> = (0..samples)
        .into_par_iter()
        .step_by(task.max(1))
        .map(|start| batch.gradients(start..samples.min(start + task)))
        .collect();
    let mut total = zeros(layers);
    for part in parts {
        for (total, part) in total.iter_mut().zip(part) {
            add(&mut total.0, &part.0);
            add(&mut total.1, &part.1);
        }
    }
    total
}

/// What [`backward`] is given; weights as [`transpose`] leaves them.
struct Batch<'a> {
    layers: &'a [Layer],
    transposed: &'a [Vec<f32>],
    input: &'a [f32],
    activations: &'a [Vec<f32>],
    gradient: &'a [f32],
    samples: usize,
}

impl Batch<'_> {
    /// Sums over some of the samples.
    fn gradients(&self, range: Range<usize>) -> Vec<Gradients> {
        let mut sums = zeros(self.layers);
        for start in range.clone().step_by(CHUNK) {
            self.descend(start..range.end.min(start + CHUNK), &mut sums);
        }
        sums
    }

    /// Adds a chunk's gradients, from the last layer to the first.
    fn descend(&self, chunk: Range<usize>, sums: &mut [Gradients]) {
        let mut gradient = self.part(self.gradient, &chunk).to_vec();
        for (i, layer) in self.layers.iter().enumerate().rev() {
            mask(&mut gradient, self.part(&self.activations[i], &chunk));
            let starts = layer.starts(chunk.len());
            let below = i.checked_sub(1).map(|below| &self.activations[below]);
            let input = self.part(below.map_or(self.input, |below| below), &chunk);
            parameter_gradients(layer, &starts, input, &gradient, &mut sums[i]);
            if below.is_some() {
                let weights = &self.transposed[i];
                gradient = input_gradient(layer, &starts, weights, &gradient, input.len());
            }
        }
    }

    /// A chunk's share of something of all samples.
    fn part<'a>(&self, all: &'a [f32], chunk: &Range<usize>) -> &'a [f32] {
        let floats = all.len() / self.samples;
        &all[chunk.start * floats..chunk.end * floats]
    }
}

/// Weights `[size][filters][size][channels]`.
fn transpose(layer: &Layer, weights: &[f32]) -> Vec<f32> {
    let (run, filters) = (layer.run(), layer.filters());
    let mut transposed = Vec::with_capacity(weights.len());
    for row in weights.chunks_exact(run * filters) {
        for filter in 0..filters {
            transposed.extend(row[filter..].iter().step_by(filters));
        }
    }
    transposed
}

/// No gradient passes where ReLU is off.
fn mask(gradient: &mut [f32], activations: &[f32]) {
    for (gradient, &activation) in gradient.iter_mut().zip(activations) {
        *gradient = if activation > 0.0 { *gradient } else { 0.0 };
    }
}

/// Adds the gradients of a layer's weights and biases.
fn parameter_gradients(
    layer: &Layer,
    starts: &[usize],
    input: &[f32],
    gradient: &[f32],
    sums: &mut Gradients,
) {
    let (run, filters) = (layer.run(), layer.filters());
    for (y, output) in sums.0.chunks_exact_mut(run * filters).enumerate() {
        let mut kernel = WeightGradient {
            starts,
            filters,
            input: &input[y * layer.pitch()..],
            gradient,
            output,
        };
        tile(&mut kernel, run, filters);
    }
    // A bias is the weight of an input that is always one.
    let mut kernel = WeightGradient {
        starts: &vec![0; starts.len()],
        filters,
        input: &[1.0],
        gradient,
        output: &mut sums.1,
    };
    tile(&mut kernel, 1, filters);
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

fn zeros(layers: &[Layer]) -> Vec<Gradients> {
    let zeros = |layer: &Layer| (vec![0.0; layer.weights()], vec![0.0; layer.filters()]);
    layers.iter().map(zeros).collect()
}

fn add(sums: &mut [f32], values: &[f32]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += value;
    }
}
