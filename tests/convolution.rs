//! Native convolutions against burn's, whose gradients are burn's own.

use burn::tensor::activation::relu;
use burn::tensor::module::conv2d;
use burn::tensor::ops::ConvOptions;
use burn::tensor::{Device, Tensor};
use footwork::kernels::rng::{gaussian, random4};
use footwork::ppo::convolution::{
    Convolution, Gradients, Layer, Parameters, backward, chain, forward,
};
use footwork::tensors::{read, upload, vector};

fn convolution(filters: usize, size: usize, stride: usize) -> Convolution {
    Convolution {
        filters,
        size,
        stride,
    }
}

fn normal(length: usize, stream: u32) -> Vec<f32> {
    let normal = |i| gaussian(random4(1, i, 0, stream));
    (0..length as u32).map(normal).collect()
}

/// A network with inputs and a gradient of its outputs.
struct Case {
    layers: Vec<Layer>,
    parameters: Vec<Gradients>,
    samples: usize,
    input: Vec<f32>,
    gradient: Vec<f32>,
}

impl Case {
    fn new(samples: usize, inputs: [usize; 3], convolutions: &[Convolution]) -> Self {
        let layers = chain(inputs, convolutions).expect("filters fit");
        let outputs = layers.last().map_or(inputs, Layer::outputs);
        let parameters = layers.iter().zip(0..).map(|(layer, i)| {
            let spread = (layer.weights() as f32 / layer.filters() as f32).sqrt();
            let weights = normal(layer.weights(), 2 * i);
            let weights = weights.iter().map(|weight| weight / spread).collect();
            (weights, normal(layer.filters(), 2 * i + 1))
        });
        let bits = normal(samples * inputs.iter().product::<usize>(), 100);
        Case {
            parameters: parameters.collect(),
            layers,
            samples,
            input: bits.iter().map(|&x| f32::from(x > 0.0)).collect(),
            gradient: normal(samples * outputs.iter().product::<usize>(), 101),
        }
    }

    fn borrowed(&self) -> Vec<Parameters<'_>> {
        let parameters = self.parameters.iter();
        parameters
            .map(|(weights, biases)| (&weights[..], &biases[..]))
            .collect()
    }

    fn run(&self) -> (Vec<Vec<f32>>, Vec<Gradients>) {
        let parameters = self.borrowed();
        let activations = forward(&self.layers, &parameters, &self.input);
        let gradients = backward(
            &self.layers,
            &parameters,
            &self.input,
            &activations,
            &self.gradient,
        );
        (activations, gradients)
    }

    /// What [`Case::run`] should give.
    fn burn(&self) -> (Vec<Vec<f32>>, Vec<Gradients>) {
        let device = Device::flex();
        let maps = |values: &[f32], [height, width, channels]: [usize; 3]| {
            let shape = [self.samples, height, width, channels];
            upload(values.to_vec(), shape, &device).permute([0, 3, 1, 2])
        };
        let (first, last) = (&self.layers[0], &self.layers[self.layers.len() - 1]);
        let mut x = Tensor::from_inner(maps(&self.input, first.inputs()));
        let mut activations = Vec::new();
        let mut leaves = Vec::new();
        for (layer, (weights, biases)) in self.layers.iter().zip(&self.parameters) {
            let Convolution {
                filters,
                size,
                stride,
            } = layer.convolution();
            let shape = [size, size, layer.inputs()[2], filters];
            let weights = upload(weights.clone(), shape, &device).permute([3, 2, 0, 1]);
            let weights = Tensor::from_inner(weights).require_grad();
            let biases = Tensor::from_inner(vector(biases, &device)).require_grad();
            let options = ConvOptions::new([stride; 2], [0; 2], [1; 2], 1);
            x = relu(conv2d(x, weights.clone(), Some(biases.clone()), options));
            activations.push(host(x.clone().inner().permute([0, 2, 3, 1])));
            leaves.push((weights, biases));
        }
        let gradient = Tensor::from_inner(maps(&self.gradient, last.outputs()));
        let gradients = x.mul(gradient).flatten::<1>(0, 3).sum_dim(0).backward();
        let of_leaf = |(weights, biases): (Tensor<4>, Tensor<1>)| {
            let weights = weights.grad(&gradients).expect("a leaf");
            let biases = biases.grad(&gradients).expect("a leaf");
            (host(weights.permute([2, 3, 1, 0])), host(biases))
        };
        (activations, leaves.into_iter().map(of_leaf).collect())
    }
}

fn host<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    read(tensor).expect("flex does not fail")
}

fn close(found: &[f32], expected: &[f32], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let scale = expected.iter().fold(1e-3f32, |most, x| most.max(x.abs()));
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        let error = (found - expected).abs() / scale;
        assert!(error < 1e-4, "{what}[{i}]: {found}, burn {expected}");
    }
}

#[test]
fn as_burn_does() {
    let paper = [convolution(16, 4, 1), convolution(32, 3, 1)];
    let fast = [convolution(16, 4, 2), convolution(32, 3, 2)];
    let odd = [
        convolution(5, 3, 1),
        convolution(7, 2, 3),
        convolution(3, 1, 1),
    ];
    // Blocks of 32, 16 and single lanes side by side.
    let wide = [convolution(53, 3, 2), convolution(35, 2, 1)];
    let whole = [convolution(20, 9, 1)];
    let cases: [(_, _, &[Convolution]); 7] = [
        (3, [16, 16, 2], &paper),
        (37, [16, 16, 2], &fast),
        (1, [16, 16, 2], &paper),
        (5, [12, 10, 3], &odd),
        (4, [11, 9, 1], &wide),
        (18, [9, 9, 4], &whole),
        (2, [7, 5, 16], &[convolution(16, 5, 3)]),
    ];
    for (samples, inputs, convolutions) in cases {
        let case = Case::new(samples, inputs, convolutions);
        let (activations, gradients) = case.run();
        let (burn_activations, burn_gradients) = case.burn();
        assert_eq!(activations.len(), convolutions.len());
        assert_eq!(gradients.len(), convolutions.len());
        for i in 0..convolutions.len() {
            let what = |of| format!("{samples} of {inputs:?}, {convolutions:?}: {of} {i}");
            close(
                &activations[i],
                &burn_activations[i],
                &what("activations of"),
            );
            close(&gradients[i].0, &burn_gradients[i].0, &what("weights of"));
            close(&gradients[i].1, &burn_gradients[i].1, &what("biases of"));
        }
    }
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    // More samples than one task sums over.
    for samples in [70, 1100] {
        let convolutions = [convolution(16, 3, 1), convolution(5, 2, 2)];
        let case = Case::new(samples, [6, 6, 2], &convolutions);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().expect("threads start").install(|| case.run())
        };
        assert_eq!(on(1), on(2));
    }
}

#[test]
fn a_sample_does_not_depend_on_its_neighbours() {
    let convolutions = [convolution(16, 4, 2), convolution(32, 3, 2)];
    let mut case = Case::new(40, [16, 16, 2], &convolutions);
    let (all, _) = case.run();
    case.input.drain(..33 * 16 * 16 * 2);
    let one = forward(&case.layers, &case.borrowed(), &case.input[..16 * 16 * 2]);
    for (all, one) in all.iter().zip(&one) {
        assert_eq!(all[33 * one.len()..34 * one.len()], one[..]);
    }
}

#[test]
fn nothing_passes_where_relu_is_off() {
    let convolutions = [convolution(16, 4, 1), convolution(32, 3, 1)];
    let mut case = Case::new(2, [16, 16, 2], &convolutions);
    case.parameters[1].1.fill(-1e3);
    let (activations, gradients) = case.run();
    assert!(activations[1].iter().all(|&x| x == 0.0));
    for (weights, biases) in &gradients {
        assert!(weights.iter().chain(biases).all(|&x| x == 0.0));
    }
}

#[test]
fn no_samples_no_layers() {
    let empty = Case::new(0, [16, 16, 2], &[convolution(16, 4, 1)]);
    let (activations, gradients) = empty.run();
    assert!(activations[0].is_empty());
    assert!(gradients[0].0.iter().all(|&x| x == 0.0));
    assert_eq!(gradients[0].0.len(), 4 * 4 * 2 * 16);
    assert_eq!(Case::new(3, [4, 4, 1], &[]).run(), (vec![], vec![]));
}

#[test]
fn what_does_not_fit_is_refused() {
    let outputs = |inputs, convolutions: &[Convolution]| {
        chain(inputs, convolutions).map(|layers| layers[layers.len() - 1].outputs())
    };
    let paper = [convolution(16, 4, 1), convolution(32, 3, 1)];
    assert_eq!(outputs([16, 16, 2], &paper), Some([11, 11, 32]));
    assert_eq!(outputs([16, 9, 2], &paper), Some([11, 4, 32]));
    assert_eq!(outputs([16, 5, 2], &paper), None);
    for nothing in [
        convolution(0, 3, 1),
        convolution(8, 0, 1),
        convolution(8, 3, 0),
    ] {
        assert_eq!(outputs([16, 16, 2], &[nothing]), None);
    }
    assert_eq!(outputs([16, 16, 0], &paper), None);
}
