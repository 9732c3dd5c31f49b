//! Policy and critic: two separate networks of the same form with linear ends, and the logarithm
//! of the actions' standard deviation.

use super::convolution;
use super::network::{Net, Place, Shape};
use crate::kernels::layout::{CELLS, GOAL, MAPS};
use crate::tensors::{upload, values};
use burn::tensor::module::{conv2d, linear};
use burn::tensor::ops::ConvOptions;
use burn::tensor::{Device, Tensor, activation::relu};
use std::ops::Range;

impl Shape {
    /// Cuts the flat vector into its tensors.
    pub fn cut(&self, flat: &Tensor<1>) -> Policy {
        let part = |range: Range<usize>| flat.clone().slice([range]);
        let dense = |place: &Place| Dense {
            weights: part(place.weights()).reshape([place.inputs, place.outputs]),
            biases: part(place.biases()),
        };
        Policy {
            actor: self.actor.map(dense),
            critic: self.critic.map(dense),
            log_std: part(self.log_std..self.parameters()),
        }
    }
}

/// A layer's parameters: weights `[inputs, outputs]` and biases `[outputs]`. The inputs of a
/// convolution are those of a patch, `[row][column][channel]`.
pub(super) struct Dense {
    pub weights: Tensor<2>,
    pub biases: Tensor<1>,
}

impl Dense {
    fn apply(&self, input: Tensor<2>) -> Tensor<2> {
        linear(input, self.weights.clone(), Some(self.biases.clone()))
    }
}

/// The parameters as tensors.
pub struct Policy {
    pub(super) actor: Net<Dense>,
    pub(super) critic: Net<Dense>,
    /// `[TRAJECTORY]`.
    pub log_std: Tensor<1>,
}

impl Policy {
    /// Mean action `[n, TRAJECTORY]` for observations `[n, width]`.
    pub fn mean(&self, observation: Tensor<2>) -> Tensor<2> {
        self.actor.answer(observation)
    }

    /// The critic's normalised value `[n]`.
    pub fn value(&self, observation: Tensor<2>) -> Tensor<1> {
        self.critic.answer(observation).squeeze_dim::<1>(1)
    }
}

impl Net<Dense> {
    fn answer(&self, observation: Tensor<2>) -> Tensor<2> {
        let (goal, maps) = split(&observation);
        let seen = match self.native(&maps) {
            true => {
                let seen =
                    convolution::forward(&self.eyes, &borrow(&self.filters()), &values(maps));
                let seen = seen.into_iter().next_back().unwrap_or_default();
                rows(seen, observation.dims()[0], &observation.device())
            }
            false => self.convolve(maps),
        };
        self.decide(goal, seen)
    }

    /// Whether the convolutions run here and not in burn: on the CPU its own are several times
    /// slower.
    pub fn native(&self, maps: &Tensor<2>) -> bool {
        !self.eyes.is_empty() && maps.device() == Device::flex()
    }

    /// Weights and biases of the convolutions on the host.
    pub fn filters(&self) -> Vec<convolution::Gradients> {
        let layers = self.convolutions.iter();
        layers
            .map(|layer| (values(layer.weights.clone()), values(layer.biases.clone())))
            .collect()
    }

    /// The convolutions by burn, `[n, height * width * filters]`.
    pub fn convolve(&self, maps: Tensor<2>) -> Tensor<2> {
        let samples = maps.dims()[0];
        if self.eyes.is_empty() {
            return maps;
        }
        let maps: Tensor<4> = maps.reshape([samples, CELLS, CELLS, MAPS]);
        let mut x = maps.permute([0, 3, 1, 2]);
        for (eye, layer) in self.eyes.iter().zip(&self.convolutions) {
            let (size, stride) = (eye.convolution().size, eye.convolution().stride);
            let weights: Tensor<4> =
                layer
                    .weights
                    .clone()
                    .reshape([size, size, eye.inputs()[2], eye.filters()]);
            let options = ConvOptions::new([stride; 2], [0; 2], [1; 2], 1);
            let weights = weights.permute([3, 2, 0, 1]);
            x = relu(conv2d(x, weights, Some(layer.biases.clone()), options));
        }
        x.permute([0, 2, 3, 1]).flatten::<2>(1, 3)
    }

    /// From what was seen `[n, ..]` and the rest of the observation `[n, GOAL]` to the answer.
    pub fn decide(&self, goal: Tensor<2>, seen: Tensor<2>) -> Tensor<2> {
        let bend = |x: Tensor<2>| if self.sees { relu(x) } else { x.tanh() };
        let seen = self
            .sight
            .iter()
            .fold(seen, |x, layer| relu(layer.apply(x)));
        let joined = if self.sees {
            Tensor::cat(vec![goal, seen], 1)
        } else {
            goal
        };
        let last = self.hidden.len() - 1;
        let hidden = self.hidden[..last].iter();
        let hidden = hidden.fold(joined, |x, layer| bend(layer.apply(x)));
        self.hidden[last].apply(hidden)
    }
}

/// The maps of an observation `[n, width]` after the rest.
pub(super) fn split(observation: &Tensor<2>) -> (Tensor<2>, Tensor<2>) {
    let width = observation.dims()[1];
    let goal = observation.clone().narrow(1, 0, GOAL);
    if width == GOAL {
        return (goal.clone(), goal);
    }
    (goal, observation.clone().narrow(1, GOAL, width - GOAL))
}

pub(super) fn borrow(filters: &[convolution::Gradients]) -> Vec<convolution::Parameters<'_>> {
    let slices = filters.iter();
    slices
        .map(|(weights, biases)| (&weights[..], &biases[..]))
        .collect()
}

/// `count` rows.
pub(super) fn rows(values: Vec<f32>, count: usize, device: &Device) -> Tensor<2> {
    let width = values.len() / count;
    upload(values, [count, width], device)
}
