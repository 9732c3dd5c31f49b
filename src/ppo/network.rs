//! The form of policy and critic, and where their parameters lie.
//!
//! On the plane: dense layers, tanh. Among obstacles the maps go through convolutions and dense
//! layers of their own, and join the rest; ReLU everywhere (paper, figure 3).

use super::convolution::{self, Convolution, Layer};
use crate::kernels::layout::{CELLS, GOAL, MAPS};
use crate::kernels::rng::{gaussian, random4};
use crate::motion::features::TRAJECTORY;
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
    pub(super) actor: Net<Place>,
    pub(super) critic: Net<Place>,
    pub(super) log_std: usize,
}

/// One network, made of layers of some kind.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Net<T> {
    /// Whether there are maps to see.
    pub sees: bool,
    pub eyes: Vec<Layer>,
    pub convolutions: Vec<T>,
    pub sight: Vec<T>,
    pub hidden: Vec<T>,
}

/// Where a layer's weights, then its biases lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// Numbers that come together in each of its outputs.
    pub inputs: usize,
    pub outputs: usize,
    start: usize,
}

impl Place {
    pub fn weights(&self) -> Range<usize> {
        self.start..self.start + self.inputs * self.outputs
    }

    pub fn biases(&self) -> Range<usize> {
        let start = self.weights().end;
        start..start + self.outputs
    }
}

impl<T> Net<T> {
    /// All layers, in the flat vector's order.
    pub fn layers(&self) -> impl Iterator<Item = &T> {
        let convolutions = self.convolutions.iter();
        convolutions.chain(&self.sight).chain(&self.hidden)
    }

    pub fn map<U>(&self, mut f: impl FnMut(&T) -> U) -> Net<U> {
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

    /// Multiplications and additions of the actor for one observation.
    pub fn actor_operations(&self) -> usize {
        let net = &self.actor;
        let places = |layer: &Layer| layer.outputs().iter().product::<usize>() / layer.filters();
        let eyes = net.eyes.iter().map(|layer| layer.weights() * places(layer));
        let dense = net.sight.iter().chain(&net.hidden);
        2 * (eyes.sum::<usize>() + dense.map(|at| at.inputs * at.outputs).sum::<usize>())
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
}
