//! The same mathematics in burn's tensors, whose gradients are burn's own: the oracle.

use burn::tensor::activation::relu;
use burn::tensor::module::{conv2d, linear};
use burn::tensor::ops::ConvOptions;
use burn::tensor::{Device, Gradients, Tensor, TensorData};
use footwork::nn::layer::{Activation, Layer};
use footwork::nn::network::{LayerParams, Network};
use footwork::rl::ppo::loss::{LossCoefficients, SUMS};

const HALF_LOG_TAU: f64 = 0.918_938_533_204_672_7;

/// Where the oracle computes.
pub fn device() -> Device {
    Device::flex()
}

pub fn tensor<const D: usize>(values: &[f32], shape: [usize; D]) -> Tensor<D> {
    Tensor::from_data(TensorData::new(values.to_vec(), shape), &device())
}

pub fn values<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    tensor.into_data().try_into_vec().expect("floats")
}

/// A flat vector as a leaf of a gradient graph.
pub fn leaf(flat: &[f32]) -> Tensor<1> {
    Tensor::from_inner(tensor(flat, [flat.len()])).require_grad()
}

/// Outputs `[n, outputs]` of a network for observations `[n, observation]`.
pub fn outputs(network: &Network, flat: &Tensor<1>, observation: Tensor<2>) -> Tensor<2> {
    let (spec, encoder) = (network.observation(), network.encoder_len());
    let vector = observation.clone().narrow(1, 0, spec.vector);
    let maps = spec.dim() - spec.vector;
    let mut x = match encoder > 0 {
        true => observation.narrow(1, spec.vector, maps),
        false => observation,
    };
    for (number, params) in network.layers().iter().enumerate() {
        if number == encoder && encoder > 0 {
            x = Tensor::cat(vec![vector.clone(), x], 1);
        }
        x = forward(params, flat, x);
    }
    x
}

fn forward(params: &LayerParams, flat: &Tensor<1>, x: Tensor<2>) -> Tensor<2> {
    let layer = &params.layer;
    let weights = flat.clone().slice([params.weights()]);
    let biases = Some(flat.clone().slice([params.biases()]));
    let sums = match layer.is_dense() {
        true => linear(x, weights.reshape([layer.patch(), layer.filters()]), biases),
        false => convolve(layer, x, weights, biases),
    };
    match layer.activation() {
        Activation::Relu => relu(sums),
        Activation::Tanh => sums.tanh(),
        Activation::Identity => sums,
    }
}

fn convolve(
    layer: &Layer,
    x: Tensor<2>,
    weights: Tensor<1>,
    biases: Option<Tensor<1>>,
) -> Tensor<2> {
    let ([height, width, channels], samples) = (layer.inputs(), x.dims()[0]);
    let x: Tensor<4> = x.reshape([samples, height, width, channels]);
    let size = layer.size();
    let weights: Tensor<4> = weights.reshape([size, size, channels, layer.filters()]);
    let options = ConvOptions::new([layer.stride(); 2], [0; 2], [1; 2], 1);
    let x = conv2d(
        x.permute([0, 3, 1, 2]),
        weights.permute([3, 2, 0, 1]),
        biases,
        options,
    );
    x.permute([0, 2, 3, 1])
        .reshape([samples, layer.output_len()])
}

/// The gradient with respect to a leaf.
pub fn gradient(leaf: &Tensor<1>, gradients: &Gradients) -> Vec<f32> {
    values(leaf.grad(gradients).expect("a gradient"))
}

/// PPO's loss of samples as [`footwork::rl::ppo::loss::PpoLoss`] has them, given the outputs, and its sums.
pub fn ppo_loss(
    samples: &Tensor<2>,
    action: usize,
    [mean, value]: [Tensor<2>; 2],
    log_std: Tensor<1>,
    old_log_std: Tensor<1>,
    coefficients: &LossCoefficients,
) -> (Tensor<1>, [f32; SUMS]) {
    let [count, width] = samples.dims();
    let part = |start: usize, length: usize| {
        Tensor::<2>::from_inner(samples.clone().narrow(1, width - start, length))
    };
    let scalar = |back: usize| part(back, 1).squeeze_dim::<1>(1);
    let (actions, old_mean) = (part(2 * action + 4, action), part(action + 4, action));
    let [old_log_prob, advantage, target, old_value] = [4, 3, 2, 1].map(scalar);
    let value = value.squeeze_dim::<1>(1);
    let old_log_std = Tensor::from_inner(old_log_std);
    let [
        clip,
        value_clip,
        value_coefficient,
        entropy_coefficient,
        kl_coefficient,
    ] = [
        coefficients.clip,
        coefficients.value_clip,
        coefficients.value_coefficient,
        coefficients.entropy_coefficient,
        coefficients.kl_coefficient,
    ]
    .map(f64::from);

    let inverse = log_std.clone().neg().exp().unsqueeze::<2>();
    let rows = |values: Tensor<2>| values.sum_dim(1).squeeze_dim::<1>(1);
    let noise = actions.sub(mean.clone()).mul(inverse.clone());
    let normaliser = log_std
        .clone()
        .sum()
        .add_scalar(action as f64 * HALF_LOG_TAU);
    let log_prob = rows(noise.square().mul_scalar(-0.5)).sub(normaliser.clone());
    let ratio = log_prob.sub(old_log_prob).exp();
    let clipped = ratio.clone().clamp(1.0 - clip, 1.0 + clip);
    let least = ratio.clone().mul(advantage.clone());
    let surrogate = least.min_pair(clipped.clone().mul(advantage)).sum().neg();

    let error = value.clone().sub(target.clone()).square();
    let near = value.sub(old_value.clone()).clamp(-value_clip, value_clip);
    let near = old_value.add(near).sub(target).square();
    let error = if value_clip > 0.0 {
        error.max_pair(near)
    } else {
        error
    };
    let value_loss = error.sum().mul_scalar(0.5);

    let entropy = normaliser
        .add_scalar(0.5 * action as f64)
        .mul_scalar(count as f64);
    // KL(old || new) of diagonal Gaussians.
    let mean_diff = old_mean.sub(mean).mul(inverse).square();
    let diff = old_log_std.sub(log_std);
    let of_std = diff
        .clone()
        .mul_scalar(2.0)
        .exp()
        .sub_scalar(1.0)
        .mul_scalar(0.5);
    let of_std = of_std.sub(diff).sum().mul_scalar(count as f64);
    let kl = rows(mean_diff.mul_scalar(0.5)).sum().add(of_std);

    let left = ratio.inner().sub(clipped.inner()).abs().greater_elem(0.0);
    let one = |sum: &Tensor<1>| values(sum.clone().inner())[0];
    let sums = [
        one(&surrogate),
        one(&value_loss),
        one(&entropy),
        one(&kl),
        values(left.float().sum())[0],
    ];
    let loss = surrogate
        .add(value_loss.mul_scalar(value_coefficient))
        .sub(entropy.mul_scalar(entropy_coefficient))
        .add(kl.mul_scalar(kl_coefficient));
    (loss.mul_scalar(f64::from(coefficients.inv_count)), sums)
}

/// The gradient of the penalty on a network's gradient with respect to its observation, from the first-order
/// expression: a product of weights and of masks that do not depend on them. Rows of `width` begin with
/// observations; those before `first` do not count.
pub fn penalty(
    network: &Network,
    heads: usize,
    flat: &[f32],
    samples: &[f32],
    width: usize,
    first: usize,
    weight: f32,
) -> Vec<f32> {
    let (rows, dim) = (samples.len() / width - first, network.observation().dim());
    let all = tensor(samples, [samples.len() / width, width]);
    let mut x = all.narrow(0, first, rows).narrow(1, 0, dim);
    let constant = tensor(flat, [flat.len()]);
    let mut masks = Vec::new();
    for params in network.layers() {
        x = forward(params, &constant, x);
        masks.push(x.clone().sign());
    }
    let leaf = leaf(flat);
    let mut seed = vec![0.0; network.outputs()];
    seed[..heads].fill(1.0 / heads as f32);
    let seed = tensor(&seed.repeat(rows), [rows, network.outputs()]);
    let mut slope = Tensor::<2>::from_inner(seed);
    for (number, params) in network.layers().iter().enumerate().rev() {
        let layer = &params.layer;
        let weights = leaf.clone().slice([params.weights()]);
        let weights: Tensor<2> = weights.reshape([layer.patch(), layer.filters()]);
        slope = slope.matmul(weights.transpose());
        if let Some(below) = number.checked_sub(1) {
            slope = slope.mul(Tensor::from_inner(masks[below].clone()));
        }
    }
    let loss = slope
        .square()
        .sum()
        .mul_scalar(f64::from(weight) / rows as f64);
    let gradients = loss.backward();
    values(leaf.grad(&gradients).expect("a gradient"))
}
