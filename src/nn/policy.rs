//! Policy and critic: two separate networks of the same form with linear ends, and the logarithm
//! of the actions' standard deviation.

use super::gpu::forward::Answering;
use super::layer::{Bend, Layer, floats};
use super::cpu;
use super::network::{Net, Place, Shape};
use crate::gpu::Buffer;
use crate::gpu::tensor::to_buffer;
use crate::kernels::locomotion::locomotion_layout::BASE_OBS_DIM;
use crate::motion::features::TRAJECTORY_DIM;
use super::tensors::{upload, values};
use burn::tensor::module::{conv2d, linear};
use burn::tensor::ops::ConvOptions;
use burn::tensor::{Device, Tensor, activation::relu};
use std::ops::Range;
use std::sync::Arc;

impl Shape {
    /// Cuts the flat vector into its tensors.
    pub fn cut(&self, flat: &Tensor<1>) -> Policy {
        let dense = |place: &Place| Dense::cut(place, flat);
        let networks = match on_cpu(&flat.device()) {
            true => Networks::Native {
                shape: self.clone(),
                flat: values(flat.clone()),
            },
            false => Networks::Burn {
                actor: self.actor.map(dense),
                critic: self.critic.map(dense),
            },
        };
        Policy {
            networks,
            log_std: self.log_std(flat),
        }
    }

    /// The same where launches of our own answer.
    pub(super) fn launched(&self, answering: &Arc<Answering>, flat: &Tensor<1>) -> Policy {
        Policy {
            networks: Networks::Launched {
                answering: answering.clone(),
                parameters: to_buffer(flat.clone()),
            },
            log_std: self.log_std(flat),
        }
    }

    fn log_std(&self, flat: &Tensor<1>) -> Tensor<1> {
        flat.clone().narrow(0, self.log_std, TRAJECTORY_DIM)
    }
}

/// Whether the networks run here and not in burn.
pub(super) fn on_cpu(device: &Device) -> bool {
    *device == Device::flex()
}

/// A layer's parameters: weights `[patch][filters]` and biases `[filters]`.
pub(super) struct Dense {
    pub layer: Layer,
    pub weights: Tensor<2>,
    pub biases: Tensor<1>,
}

pub struct Policy {
    networks: Networks,
    /// `[TRAJECTORY_DIM]`.
    pub log_std: Tensor<1>,
}

enum Networks {
    Burn {
        actor: Net<Dense>,
        critic: Net<Dense>,
    },
    Native {
        shape: Shape,
        flat: Vec<f32>,
    },
    Launched {
        answering: Arc<Answering>,
        parameters: Buffer<f32>,
    },
}

impl Policy {
    /// Mean action `[n, TRAJECTORY_DIM]` for observations `[n, width]`.
    pub fn mean(&self, observation: Tensor<2>) -> Tensor<2> {
        match &self.networks {
            Networks::Burn { actor, .. } => actor.answer(observation),
            Networks::Native { shape, flat } => natively(&shape.actor, flat, observation),
            Networks::Launched {
                answering,
                parameters,
            } => answering.answer(0, TRAJECTORY_DIM, parameters, observation),
        }
    }

    /// The critic's normalised value `[n]`.
    pub fn value(&self, observation: Tensor<2>) -> Tensor<1> {
        let answer = match &self.networks {
            Networks::Burn { critic, .. } => critic.answer(observation),
            Networks::Native { shape, flat } => natively(&shape.critic, flat, observation),
            Networks::Launched {
                answering,
                parameters,
            } => answering.answer(1, 1, parameters, observation),
        };
        answer.squeeze_dim::<1>(1)
    }
}

fn natively(net: &Net<Place>, flat: &[f32], observation: Tensor<2>) -> Tensor<2> {
    let ([samples, width], device) = (observation.dims(), observation.device());
    let answers = cpu::answer(net, flat, &values(observation), width);
    let each = answers.len() / samples;
    upload(answers, [samples, each], &device)
}

impl Net<Dense> {
    /// `[n, ..]` for observations `[n, width]`.
    pub fn answer(&self, observation: Tensor<2>) -> Tensor<2> {
        let width = observation.dims()[1];
        let goal = observation.clone().narrow(1, 0, BASE_OBS_DIM);
        let joined = match self.sees {
            true => {
                let maps = observation.narrow(1, BASE_OBS_DIM, width - BASE_OBS_DIM);
                Tensor::cat(vec![goal, through(&self.sight, maps)], 1)
            }
            false => goal,
        };
        through(&self.hidden, joined)
    }
}

fn through(layers: &[Dense], input: Tensor<2>) -> Tensor<2> {
    layers.iter().fold(input, |x, layer| layer.apply(x))
}

impl Dense {
    /// Of the flat vector.
    pub fn cut(place: &Place, flat: &Tensor<1>) -> Dense {
        let part = |range: Range<usize>| flat.clone().slice([range]);
        let layer = place.layer;
        Dense {
            layer,
            weights: part(place.weights()).reshape([layer.patch(), layer.filters()]),
            biases: part(place.biases()),
        }
    }

    fn apply(&self, input: Tensor<2>) -> Tensor<2> {
        let (weights, biases) = (self.weights.clone(), Some(self.biases.clone()));
        let sums = match self.layer.is_dense() {
            true => linear(input, weights, biases),
            false => convolve(&self.layer, input, weights, biases),
        };
        match self.layer.bend() {
            Bend::Relu => relu(sums),
            Bend::Tanh => sums.tanh(),
            Bend::None => sums,
        }
    }
}

/// Inputs and outputs `[n, height * width * channels]`, channels last.
fn convolve(
    layer: &Layer,
    input: Tensor<2>,
    weights: Tensor<2>,
    biases: Option<Tensor<1>>,
) -> Tensor<2> {
    let ([height, width, channels], samples) = (layer.inputs(), input.dims()[0]);
    let input: Tensor<4> = input.reshape([samples, height, width, channels]);
    let size = layer.size();
    let weights: Tensor<4> = weights.reshape([size, size, channels, layer.filters()]);
    let options = ConvOptions::new([layer.stride(); 2], [0; 2], [1; 2], 1);
    let output = conv2d(
        input.permute([0, 3, 1, 2]),
        weights.permute([3, 2, 0, 1]),
        biases,
        options,
    );
    let output = output.permute([0, 2, 3, 1]);
    output.reshape([samples, floats(layer.outputs())])
}
