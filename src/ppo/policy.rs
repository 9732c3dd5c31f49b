//! Policy and critic: two separate networks of the same form with linear ends, and the logarithm
//! of the actions' standard deviation (paper, figure 3).
//!
//! On the plane: dense layers, tanh. Among obstacles the maps go through convolutions and dense
//! layers of their own, and join the rest; ReLU everywhere.

use super::convolution::{self, Convolution, Layer};
use crate::kernels::layout::{CELLS, GOAL, MAPS};
use crate::kernels::rng::{gaussian, random4};
use crate::motion::features::TRAJECTORY;
use crate::tensors::{upload, values};
use burn::tensor::module::{conv2d, linear};
use burn::tensor::ops::ConvOptions;
use burn::tensor::{Device, Gradients, Tensor, activation::relu};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Hidden layers of policy and critic alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Network {
    /// Of the obstacle maps.
    pub convolutions: Vec<Convolution>,
    /// Widths of the dense layers that follow them, before the rest of the observation joins.
    pub sight: Vec<usize>,
    /// Widths of the dense layers after that.
    pub hidden: Vec<usize>,
}

/// Places of all parameters in one flat vector.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    actor: Net<Place>,
    critic: Net<Place>,
    log_std: usize,
}

/// One network, made of layers of some kind.
#[derive(Clone, Debug, PartialEq)]
struct Net<T> {
    /// Whether there are maps to see.
    sees: bool,
    eyes: Vec<Layer>,
    convolutions: Vec<T>,
    sight: Vec<T>,
    hidden: Vec<T>,
}

/// Where a layer's weights, then its biases lie.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    /// Numbers that come together in each of its outputs.
    inputs: usize,
    outputs: usize,
    start: usize,
}

impl Place {
    fn weights(&self) -> Range<usize> {
        self.start..self.start + self.inputs * self.outputs
    }

    fn biases(&self) -> Range<usize> {
        let start = self.weights().end;
        start..start + self.outputs
    }
}

impl<T> Net<T> {
    /// All layers, in the flat vector's order.
    fn layers(&self) -> impl Iterator<Item = &T> {
        let convolutions = self.convolutions.iter();
        convolutions.chain(&self.sight).chain(&self.hidden)
    }

    fn map<U>(&self, mut f: impl FnMut(&T) -> U) -> Net<U> {
        Net {
            sees: self.sees,
            eyes: self.eyes.clone(),
            convolutions: self.convolutions.iter().map(&mut f).collect(),
            sight: self.sight.iter().map(&mut f).collect(),
            hidden: self.hidden.iter().map(&mut f).collect(),
        }
    }
}

impl Network {
    /// The layers of the convolutions over the maps; none if a filter does not fit its input.
    pub fn eyes(&self) -> Option<Vec<Layer>> {
        convolution::chain([CELLS, CELLS, MAPS], &self.convolutions)
    }
}

impl Shape {
    /// For observations of `width` numbers; none if a filter of the network does not fit its input.
    pub fn new(network: &Network, width: usize) -> Option<Self> {
        let mut end = 0;
        let mut place = |inputs: usize, outputs: usize| {
            let place = Place {
                inputs,
                outputs,
                start: end,
            };
            end = place.biases().end;
            place
        };
        let sees = width > GOAL;
        let eyes = if sees { network.eyes()? } else { Vec::new() };
        let mut net = |ends: usize| {
            let convolutions = eyes.iter().map(|layer| {
                let filters = layer.filters();
                place(layer.weights() / filters, filters)
            });
            let convolutions = convolutions.collect();
            let mut inputs = eyes
                .last()
                .map_or(width - GOAL, |layer| layer.outputs().iter().product());
            let mut dense =
                |outputs: usize| place(std::mem::replace(&mut inputs, outputs), outputs);
            let sight = if sees { &network.sight[..] } else { &[] };
            let sight = sight.iter().map(|&outputs| dense(outputs)).collect();
            inputs += GOAL;
            let mut dense =
                |outputs: usize| place(std::mem::replace(&mut inputs, outputs), outputs);
            let hidden = network.hidden.iter().chain([&ends]);
            let hidden = hidden.map(|&outputs| dense(outputs)).collect();
            Net {
                sees,
                eyes: eyes.clone(),
                convolutions,
                sight,
                hidden,
            }
        };
        let (actor, critic) = (net(TRAJECTORY), net(1));
        Some(Shape {
            actor,
            critic,
            log_std: end,
        })
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
        for net in [&self.actor, &self.critic] {
            let depth = net.layers().count();
            // ReLU halves what passes; tanh leaves it.
            let gain = if net.sees { 2f32.sqrt() } else { 1.0 };
            for (at, place) in net.layers().enumerate() {
                let gain = if at + 1 == depth { LAST_GAIN } else { gain };
                let deviation = gain / (place.inputs as f32).sqrt();
                for at in place.weights() {
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
struct Dense {
    weights: Tensor<2>,
    biases: Tensor<1>,
}

impl Dense {
    /// The same parameters as leaves of a gradient graph.
    fn leaves(&self) -> Dense {
        Dense {
            weights: Tensor::from_inner(self.weights.clone()).require_grad(),
            biases: Tensor::from_inner(self.biases.clone()).require_grad(),
        }
    }

    fn apply(&self, input: Tensor<2>) -> Tensor<2> {
        linear(input, self.weights.clone(), Some(self.biases.clone()))
    }
}

/// The parameters as tensors.
pub struct Policy {
    actor: Net<Dense>,
    critic: Net<Dense>,
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

    /// The same parameters as leaves of a gradient graph, about to learn from observations
    /// `[n, width]`.
    pub fn study(&self, observation: &Tensor<2>) -> Study {
        Study {
            actor: self.actor.study(observation),
            critic: self.critic.study(observation),
            log_std: Tensor::from_inner(self.log_std.clone()).require_grad(),
        }
    }
}

/// Policy and critic on the way from a batch of observations to the gradients of a loss.
pub struct Study {
    actor: NetStudy,
    critic: NetStudy,
    pub log_std: Tensor<1>,
}

impl Study {
    /// See [`Policy::mean`].
    pub fn mean(&self) -> Tensor<2> {
        self.actor.answer()
    }

    /// See [`Policy::value`].
    pub fn value(&self) -> Tensor<1> {
        self.critic.answer().squeeze_dim::<1>(1)
    }

    /// Gradients of all parameters in the flat vector's order; zero where the loss does not depend
    /// on one.
    pub fn gradient(&self, gradients: &Gradients) -> Tensor<1> {
        let mut parts = self.actor.gradient(gradients);
        parts.extend(self.critic.gradient(gradients));
        parts.push(gradient_of(&self.log_std, gradients));
        Tensor::cat(parts, 0)
    }
}

fn gradient_of<const D: usize>(leaf: &Tensor<D>, gradients: &Gradients) -> Tensor<D> {
    let gradient = leaf.grad(gradients);
    gradient.unwrap_or_else(|| leaf.clone().inner().zeros_like())
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
    fn native(&self, maps: &Tensor<2>) -> bool {
        !self.eyes.is_empty() && maps.device() == Device::flex()
    }

    /// Weights and biases of the convolutions on the host.
    fn filters(&self) -> Vec<convolution::Gradients> {
        let layers = self.convolutions.iter();
        layers
            .map(|layer| (values(layer.weights.clone()), values(layer.biases.clone())))
            .collect()
    }

    /// The convolutions by burn, `[n, height * width * filters]`.
    fn convolve(&self, maps: Tensor<2>) -> Tensor<2> {
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
    fn decide(&self, goal: Tensor<2>, seen: Tensor<2>) -> Tensor<2> {
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

    fn study(&self, observation: &Tensor<2>) -> NetStudy {
        let leaves = self.map(Dense::leaves);
        let (goal, maps) = split(observation);
        let goal = Tensor::from_inner(goal);
        if !self.native(&maps) {
            let seen = leaves.convolve(Tensor::from_inner(maps));
            let tape = None;
            return NetStudy {
                leaves,
                goal,
                seen,
                tape,
            };
        }
        let (filters, maps) = (self.filters(), values(maps));
        let activations = convolution::forward(&self.eyes, &borrow(&filters), &maps);
        let seen = activations.last().cloned().unwrap_or_default();
        let seen = rows(seen, observation.dims()[0], &observation.device());
        NetStudy {
            leaves,
            goal,
            seen: Tensor::from_inner(seen).require_grad(),
            tape: Some(Tape {
                filters,
                maps,
                activations,
            }),
        }
    }
}

/// One network's part of a [`Study`].
struct NetStudy {
    leaves: Net<Dense>,
    goal: Tensor<2>,
    /// What the convolutions saw: a leaf if they ran here.
    seen: Tensor<2>,
    tape: Option<Tape>,
}

/// What going back through the convolutions needs.
struct Tape {
    filters: Vec<convolution::Gradients>,
    maps: Vec<f32>,
    activations: Vec<Vec<f32>>,
}

impl NetStudy {
    fn answer(&self) -> Tensor<2> {
        self.leaves.decide(self.goal.clone(), self.seen.clone())
    }

    fn gradient(&self, gradients: &Gradients) -> Vec<Tensor<1>> {
        let dense = |layer: &Dense| {
            let weights = gradient_of(&layer.weights, gradients).flatten::<1>(0, 1);
            [weights, gradient_of(&layer.biases, gradients)]
        };
        let Some(tape) = &self.tape else {
            return self.leaves.layers().flat_map(dense).collect();
        };
        let seen = gradient_of(&self.seen, gradients);
        let device = seen.device();
        let convolutions = convolution::backward(
            &self.leaves.eyes,
            &borrow(&tape.filters),
            &tape.maps,
            &tape.activations,
            &values(seen),
        );
        let convolutions = convolutions.into_iter().flat_map(|(weights, biases)| {
            [weights, biases].map(|values| {
                let length = values.len();
                upload(values, [length], &device)
            })
        });
        let rest = self.leaves.sight.iter().chain(&self.leaves.hidden);
        convolutions.chain(rest.flat_map(dense)).collect()
    }
}

/// The maps of an observation `[n, width]` after the rest.
fn split(observation: &Tensor<2>) -> (Tensor<2>, Tensor<2>) {
    let width = observation.dims()[1];
    let goal = observation.clone().narrow(1, 0, GOAL);
    if width == GOAL {
        return (goal.clone(), goal);
    }
    (goal, observation.clone().narrow(1, GOAL, width - GOAL))
}

fn borrow(filters: &[convolution::Gradients]) -> Vec<convolution::Parameters<'_>> {
    let slices = filters.iter();
    slices
        .map(|(weights, biases)| (&weights[..], &biases[..]))
        .collect()
}

/// `count` rows.
fn rows(values: Vec<f32>, count: usize, device: &Device) -> Tensor<2> {
    let width = values.len() / count;
    upload(values, [count, width], device)
}
