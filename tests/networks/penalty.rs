//! The penalty on a network's gradient with respect to its observation.
//! Oracles: central differences in f64 of the plain definition; burn's autodiff of the first-order expression;
//! for tensors on the GPU, the CPU. Bar: roundings of sums.

use crate::autodiff;
use crate::normal;
use footwork::gpu::{Array, Device};
use footwork::nn::layer::Activation;
use footwork::nn::network::{Network, NetworkConfig};
use footwork::nn::observation::ObservationSpec;
use footwork::nn::{Engine, EngineSize};

const DIM: usize = 9;
const ROWS: usize = 37;
const WEIGHT: f32 = 5.0;

fn network(hidden: &[usize], outputs: usize) -> Network {
    let config = NetworkConfig {
        convolutions: Vec::new(),
        encoder_hidden: Vec::new(),
        hidden: hidden.to_vec(),
        activation: Activation::Relu,
    };
    let window = ObservationSpec {
        vector: DIM,
        grid: None,
    };
    Network::new(&config, &window, outputs, 0).expect("a network")
}

fn flat(network: &Network) -> Vec<f32> {
    normal(network.span().len(), 3)
        .iter()
        .map(|value| 0.3 * value)
        .collect()
}

/// The gradient that the penalty adds, and the sum of squared norms.
fn added(device: &Device, network: &Network, heads: usize, samples: &[f32]) -> (Vec<f32>, f32) {
    let flat = flat(network);
    let size = EngineSize {
        parameters: flat.len(),
        extras: 1,
        max_rows: ROWS,
        minibatch: ROWS,
    };
    let engine = Engine::layerwise(device, vec![network.clone()], size).expect("an engine");
    let array = |values: &[f32]| Array::from_slice(device, values);
    let before = vec![0.5; flat.len()];
    let (mut gradient, mut sums) = (array(&before), array(&[2.0, 3.0]));
    engine.add_gradient_penalty(
        0,
        &array(&flat),
        &array(samples),
        DIM + 1,
        2..ROWS,
        heads,
        WEIGHT,
        &mut gradient,
        &mut sums,
    );
    let gradient = gradient.read(device).expect("the device is there");
    let sums = sums.read(device).expect("the device is there");
    assert_eq!(sums[1], 3.0, "only the first sum is added to");
    (
        gradient.iter().map(|value| value - 0.5).collect(),
        sums[0] - 2.0,
    )
}

/// The gradient of the mean of the heads with respect to a row, in f64, by the chain rule.
fn slope(network: &Network, heads: usize, flat: &[f64], row: &[f32]) -> Vec<f64> {
    let mut values: Vec<f64> = row.iter().map(|&value| f64::from(value)).collect();
    let mut jacobian: Vec<Vec<f64>> = (0..DIM)
        .map(|i| (0..DIM).map(|j| f64::from(u8::from(i == j))).collect())
        .collect();
    for params in network.layers() {
        let (weights, biases) = (&flat[params.weights()], &flat[params.biases()]);
        let filters = params.layer.filters();
        let taken = |of: &[f64], bias: bool| -> Vec<f64> {
            (0..filters)
                .map(|filter| {
                    let terms = of.iter().enumerate();
                    let sum: f64 = terms
                        .map(|(i, value)| value * weights[i * filters + filter])
                        .sum();
                    sum + if bias { biases[filter] } else { 0.0 }
                })
                .collect()
        };
        let sums = taken(&values, true);
        let hidden = params.layer.activation() == Activation::Relu;
        let open = |filter: usize| !hidden || sums[filter] > 0.0;
        let masked = |of: Vec<f64>| -> Vec<f64> {
            let values = of.into_iter().enumerate();
            values
                .map(|(filter, value)| if open(filter) { value } else { 0.0 })
                .collect()
        };
        jacobian = jacobian
            .iter()
            .map(|row| masked(taken(row, false)))
            .collect();
        values = masked(sums.clone());
    }
    jacobian
        .iter()
        .map(|row| row[..heads].iter().sum::<f64>() / heads as f64)
        .collect()
}

fn plain(network: &Network, heads: usize, flat: &[f64], samples: &[f32]) -> f64 {
    let rows = samples.chunks_exact(DIM + 1).skip(2);
    let squares = rows.map(|row| {
        let slope = slope(network, heads, flat, &row[..DIM]);
        slope.iter().map(|value| value * value).sum::<f64>()
    });
    squares.sum()
}

#[test]
fn it_is_that_of_central_differences() {
    let samples = normal(ROWS * (DIM + 1), 11);
    // Behind the heads may be outputs of others.
    for (hidden, outputs, heads) in [(&[8, 6][..], 1, 1), (&[7], 3, 3), (&[], 2, 2), (&[8], 5, 2)] {
        let network = network(hidden, outputs);
        let wide: Vec<f64> = flat(&network)
            .iter()
            .map(|&value| f64::from(value))
            .collect();
        let (gradient, square) = added(&Device::Cpu, &network, heads, &samples);
        let want = plain(&network, heads, &wide, &samples);
        assert!(
            (f64::from(square) - want).abs() < 1e-4 * want,
            "{square} {want}"
        );
        let count = (ROWS - 2) as f64;
        for (at, got) in gradient.iter().enumerate() {
            let moved = |by: f64| {
                let mut wide = wide.clone();
                wide[at] += by;
                plain(&network, heads, &wide, &samples)
            };
            let slope = (moved(1e-7) - moved(-1e-7)) / 2e-7 * f64::from(WEIGHT) / count;
            let error = (f64::from(*got) - slope).abs();
            assert!(
                error < 2e-4 * (1.0 + slope.abs()),
                "{hidden:?}, {at}: {got} instead of {slope}"
            );
        }
    }
}

/// Wide layers take other paths than narrow ones.
#[test]
fn it_is_that_of_autodiff_and_the_same_on_a_gpu() {
    let samples = normal(ROWS * (DIM + 1), 12);
    for (hidden, outputs, heads) in [(&[130, 100][..], 1, 1), (&[20, 10], 4, 4), (&[20], 7, 3)] {
        let network = network(hidden, outputs);
        let (gradient, square) = added(&Device::Cpu, &network, heads, &samples);
        let (on_gpu, gpu_square) = added(&crate::lavapipe(), &network, heads, &samples);
        let largest = gradient
            .iter()
            .fold(0.0f32, |most, value| most.max(value.abs()));
        assert!((square - gpu_square).abs() < 1e-4 * square);
        let oracle = autodiff::penalty(
            &network,
            heads,
            &flat(&network),
            &samples,
            DIM + 1,
            2,
            WEIGHT,
        );
        for (at, got) in gradient.iter().enumerate() {
            for (name, want) in [("autodiff", oracle[at]), ("GPU", on_gpu[at])] {
                assert!(
                    (got - want).abs() < 1e-4 * largest,
                    "{name}, {at}: {got} {want}"
                );
            }
        }
    }
}
