//! The form of policy and critic, and where their parameters lie.
//!
//! On the plane: dense layers, tanh. Among obstacles the maps go through convolutions and dense
//! layers of their own, and join the rest; ReLU everywhere (paper, figure 3).

use super::layer::{Bend, Convolution, Layer, floats};
use crate::kernels::locomotion::locomotion_layout::{CELLS, BASE_OBS_DIM, MAPS};
use crate::kernels::rng::{gaussian, random4};
use crate::motion::features::TRAJECTORY_DIM;
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
pub struct Net<T> {
    /// Whether there are maps to see.
    pub sees: bool,
    /// From the maps to what joins the rest of the observation: convolutions, then dense layers.
    pub sight: Vec<T>,
    /// From there to the answer.
    pub hidden: Vec<T>,
}

/// Where a layer's weights, then its biases lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    pub layer: Layer,
    start: usize,
}

impl Place {
    pub fn weights(&self) -> Range<usize> {
        self.start..self.start + self.layer.patch() * self.layer.filters()
    }

    pub fn biases(&self) -> Range<usize> {
        let start = self.weights().end;
        start..start + self.layer.filters()
    }
}

impl<T> Net<T> {
    /// All layers, in the flat vector's order.
    pub fn layers(&self) -> impl Iterator<Item = &T> {
        self.sight.iter().chain(&self.hidden)
    }

    pub fn map<U>(&self, f: impl Fn(&T) -> U) -> Net<U> {
        Net {
            sees: self.sees,
            sight: self.sight.iter().map(&f).collect(),
            hidden: self.hidden.iter().map(&f).collect(),
        }
    }
}

impl Net<Place> {
    fn operations(&self) -> usize {
        self.layers().map(|place| place.layer.operations()).sum()
    }

    /// All its parameters.
    pub fn span(&self) -> Range<usize> {
        let start = self.layers().next().map_or(0, |first| first.start);
        start..self.layers().last().map_or(0, |last| last.biases().end)
    }
}

impl Network {
    /// The layers of the convolutions over the maps; none if a filter does not fit its input.
    pub fn eyes(&self) -> Option<Vec<Layer>> {
        let mut inputs = [CELLS, CELLS, MAPS];
        let layers = self.convolutions.iter().map(|&convolution| {
            let layer = Layer::convolution(inputs, convolution, Bend::Relu)?;
            inputs = layer.outputs();
            Some(layer)
        });
        layers.collect()
    }

    /// The layers of a network that answers with `answers` numbers.
    fn net(&self, sees: bool, answers: usize) -> Option<Net<Layer>> {
        let bend = if sees { Bend::Relu } else { Bend::Tanh };
        let mut sight = if sees { self.eyes()? } else { Vec::new() };
        let maps = if sees { CELLS * CELLS * MAPS } else { 0 };
        let mut inputs = sight.last().map_or(maps, |layer| floats(layer.outputs()));
        if sees {
            for &outputs in &self.sight {
                sight.push(Layer::dense(inputs, outputs, bend));
                inputs = outputs;
            }
        }
        inputs += BASE_OBS_DIM;
        let mut hidden = Vec::with_capacity(self.hidden.len() + 1);
        for &outputs in &self.hidden {
            hidden.push(Layer::dense(inputs, outputs, bend));
            inputs = outputs;
        }
        hidden.push(Layer::dense(inputs, answers, Bend::None));
        Some(Net {
            sees,
            sight,
            hidden,
        })
    }
}

impl Shape {
    /// For observations of `width` numbers; none if a filter of the network does not fit its input.
    pub fn new(network: &Network, width: usize) -> Option<Self> {
        let sees = width > BASE_OBS_DIM;
        let mut start = 0;
        let mut place = |net: Net<Layer>| {
            let mut place = |layer: Layer| {
                let place = Place { layer, start };
                start = place.biases().end;
                place
            };
            Net {
                sees,
                sight: net.sight.into_iter().map(&mut place).collect(),
                hidden: net.hidden.into_iter().map(&mut place).collect(),
            }
        };
        let actor = place(network.net(sees, TRAJECTORY_DIM)?);
        let critic = place(network.net(sees, 1)?);
        Some(Shape {
            log_std: critic.span().end,
            actor,
            critic,
        })
    }

    /// Multiplications and additions of both networks for one observation.
    pub fn operations(&self) -> usize {
        self.actor.operations() + self.critic.operations()
    }

    /// Multiplications and additions of the actor for one observation.
    pub fn actor_operations(&self) -> usize {
        self.actor.operations()
    }

    /// Length of the flat vector.
    pub fn parameters(&self) -> usize {
        self.log_std + TRAJECTORY_DIM
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
                let deviation = gain / (place.layer.patch() as f32).sqrt();
                for at in place.weights() {
                    flat[at] = deviation * gaussian(random4(seed, at as u32, 0, STREAM));
                }
            }
        }
        flat[self.log_std..].fill(log_std);
        flat
    }
}
