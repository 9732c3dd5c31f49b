//! Policy and critic: two separate networks of the same hidden widths, tanh, with linear ends
//! (paper, figure 3, left), and the logarithm of the actions' standard deviation.

use crate::kernels::layout::OBSERVATION;
use crate::kernels::rng::{gaussian, random4};
use crate::motion::features::TRAJECTORY;
use burn::tensor::module::linear;
use burn::tensor::{Gradients, Tensor};
use std::ops::Range;

/// Places of all parameters in one flat vector.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    actor: Vec<Layer>,
    critic: Vec<Layer>,
    log_std: usize,
}

#[derive(Clone, Debug, PartialEq)]
struct Layer {
    inputs: usize,
    outputs: usize,
    /// Where its weights, then its biases begin.
    start: usize,
}

impl Layer {
    fn weights(&self) -> Range<usize> {
        self.start..self.start + self.inputs * self.outputs
    }

    fn biases(&self) -> Range<usize> {
        let start = self.weights().end;
        start..start + self.outputs
    }
}

impl Shape {
    pub fn new(hidden: &[usize]) -> Self {
        let mut end = 0;
        let mut chain = |outputs: usize| {
            let widths: Vec<usize> = [&[OBSERVATION], hidden, &[outputs]].concat();
            let layers = widths.windows(2).map(|pair| {
                let layer = Layer {
                    inputs: pair[0],
                    outputs: pair[1],
                    start: end,
                };
                end = layer.biases().end;
                layer
            });
            layers.collect()
        };
        let (actor, critic) = (chain(TRAJECTORY), chain(1));
        Shape {
            actor,
            critic,
            log_std: end,
        }
    }

    /// Length of the flat vector.
    pub fn parameters(&self) -> usize {
        self.log_std + TRAJECTORY
    }

    /// Gaussian weights of unit gain, nearly none in the last layers, so that learning starts
    /// from the plain distribution and the mean value (as RLlib's networks do); zero biases.
    pub fn init(&self, seed: u32, log_std: f32) -> Vec<f32> {
        const STREAM: u32 = 0x494e_4954;
        const LAST_GAIN: f32 = 0.01;
        let mut flat = vec![0.0; self.parameters()];
        for layers in [&self.actor, &self.critic] {
            for (depth, layer) in layers.iter().enumerate() {
                let gain = if depth + 1 == layers.len() {
                    LAST_GAIN
                } else {
                    1.0
                };
                let deviation = gain / (layer.inputs as f32).sqrt();
                for at in layer.weights() {
                    flat[at] = deviation * gaussian(random4(seed, at as u32, 0, STREAM));
                }
            }
        }
        flat[self.log_std..].fill(log_std);
        flat
    }

    /// Cuts the flat vector into its tensors.
    pub fn cut(&self, flat: &Tensor<1>) -> Policy {
        let part = |range: Range<usize>| flat.clone().slice([range]);
        let chain = |layers: &[Layer]| {
            let cut = layers.iter().map(|layer| {
                let weights = part(layer.weights()).reshape([layer.inputs, layer.outputs]);
                (weights, part(layer.biases()))
            });
            cut.collect()
        };
        Policy {
            actor: chain(&self.actor),
            critic: chain(&self.critic),
            log_std: part(self.log_std..self.parameters()),
        }
    }
}

/// Weights `[inputs, outputs]` and biases, layer by layer.
type Chain = Vec<(Tensor<2>, Tensor<1>)>;

/// The parameters as tensors.
pub struct Policy {
    actor: Chain,
    critic: Chain,
    /// `[TRAJECTORY]`.
    pub log_std: Tensor<1>,
}

impl Policy {
    /// Mean action `[n, TRAJECTORY]` for observations `[n, OBSERVATION]`.
    pub fn mean(&self, observation: Tensor<2>) -> Tensor<2> {
        forward(&self.actor, observation)
    }

    /// The critic's normalised value `[n]`.
    pub fn value(&self, observation: Tensor<2>) -> Tensor<1> {
        forward(&self.critic, observation).squeeze_dim::<1>(1)
    }

    /// The same parameters as leaves of a gradient graph.
    pub fn leaves(&self) -> Policy {
        let chain = |chain: &Chain| {
            let lift = |(weights, biases): &(Tensor<2>, Tensor<1>)| {
                let weights = Tensor::from_inner(weights.clone()).require_grad();
                (weights, Tensor::from_inner(biases.clone()).require_grad())
            };
            chain.iter().map(lift).collect()
        };
        Policy {
            actor: chain(&self.actor),
            critic: chain(&self.critic),
            log_std: Tensor::from_inner(self.log_std.clone()).require_grad(),
        }
    }

    /// Gradients of the leaves in the flat vector's order; zero where the loss does not depend
    /// on a parameter.
    pub fn gradient(&self, gradients: &Gradients) -> Tensor<1> {
        let mut parts = Vec::new();
        for (weights, biases) in self.actor.iter().chain(&self.critic) {
            let of_weights = weights
                .grad(gradients)
                .unwrap_or_else(|| weights.clone().inner().zeros_like());
            parts.push(of_weights.flatten::<1>(0, 1));
            parts.push(
                biases
                    .grad(gradients)
                    .unwrap_or_else(|| biases.clone().inner().zeros_like()),
            );
        }
        parts.push(
            self.log_std
                .grad(gradients)
                .unwrap_or_else(|| self.log_std.clone().inner().zeros_like()),
        );
        Tensor::cat(parts, 0)
    }
}

fn forward(chain: &Chain, input: Tensor<2>) -> Tensor<2> {
    let last = chain.len() - 1;
    chain
        .iter()
        .enumerate()
        .fold(input, |x, (depth, (weights, biases))| {
            let x = linear(x, weights.clone(), Some(biases.clone()));
            if depth < last { x.tanh() } else { x }
        })
}
