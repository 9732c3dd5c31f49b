//! The form of a network, and where its parameters lie in a flat vector.
//!
//! The maps of an observation, where there are any, go through convolutions and dense layers of their
//! own; what these make of them joins the observation's vector, and both go through the trunk.

use super::layer::{Activation, Convolution, Layer};
use super::observation::ObservationSpec;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The hidden layers of a network, as they are chosen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NetworkConfig {
    /// Convolutions over the maps.
    pub convolutions: Vec<Convolution>,
    /// Widths of the dense layers behind them, before the vector joins.
    pub encoder_hidden: Vec<usize>,
    /// Widths of the dense layers behind that.
    pub hidden: Vec<usize>,
    /// What all hidden layers do to their sums.
    pub activation: Activation,
}

/// Two small hidden layers, for observations without maps.
impl Default for NetworkConfig {
    fn default() -> Self {
        NetworkConfig {
            convolutions: Vec::new(),
            encoder_hidden: Vec::new(),
            hidden: vec![32, 32],
            activation: Activation::Tanh,
        }
    }
}

/// A network that cannot be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NetworkError {
    /// More layers of a kind than are possible.
    #[error("{key} has {layers} layers; at most {MAX_DEPTH} are possible")]
    TooDeep {
        /// Key of [`NetworkConfig`] that lists them.
        key: &'static str,
        /// Layers listed there.
        layers: usize,
    },
    /// A dense layer of no width, or wider than is possible.
    #[error("{key} has a layer of width {width}; possible are 1 to {MAX_WIDTH}")]
    Width {
        /// Key of [`NetworkConfig`] that lists the layer.
        key: &'static str,
        /// Width of the layer.
        width: usize,
    },
    /// A convolution with a number out of its range.
    #[error("convolutions has a {what} of {value}; possible are 1 to {most}")]
    Convolution {
        /// Which number, in words: of filters, a filter's size, or the stride.
        what: &'static str,
        /// The number as configured.
        value: usize,
        /// Largest value possible.
        most: usize,
    },
    /// A filter larger than the maps it would go over.
    #[error(
        "convolutions has a filter of {size} x {size} cells over an input of {height} x {width}: each convolution makes the maps smaller"
    )]
    FilterTooLarge {
        /// Height and width of the filter, cells.
        size: usize,
        /// Height of the convolution's input, cells.
        height: usize,
        /// Width of the convolution's input, cells.
        width: usize,
    },
    /// Layers for maps, where observations have none.
    #[error("{key} needs maps, and this task's observation has none: leave it empty")]
    NoGrid {
        /// Key of [`NetworkConfig`] that lists the layers.
        key: &'static str,
    },
}

/// The most layers of a kind.
pub const MAX_DEPTH: usize = 8;
/// The most numbers of a dense layer.
pub const MAX_WIDTH: usize = 2048;
const MAX_FILTERS: usize = 256;
const MAX_FILTER_SIZE: usize = 16;

impl NetworkConfig {
    fn check(&self) -> Result<(), NetworkError> {
        depth("convolutions", self.convolutions.len())?;
        for (key, widths) in [
            ("encoder_hidden", &self.encoder_hidden),
            ("hidden", &self.hidden),
        ] {
            depth(key, widths.len())?;
            if let Some(&width) = widths
                .iter()
                .find(|width| !(1..=MAX_WIDTH).contains(*width))
            {
                return Err(NetworkError::Width { key, width });
            }
        }
        for convolution in &self.convolutions {
            for (what, value, most) in [
                ("number of filters", convolution.filters, MAX_FILTERS),
                ("filter size", convolution.size, MAX_FILTER_SIZE),
                ("stride", convolution.stride, MAX_FILTER_SIZE),
            ] {
                if !(1..=most).contains(&value) {
                    return Err(NetworkError::Convolution { what, value, most });
                }
            }
        }
        Ok(())
    }

    /// The layers of the convolutions over maps of that shape.
    fn conv_layers(&self, grid: [usize; 3]) -> Result<Vec<Layer>, NetworkError> {
        let mut inputs = grid;
        let layers = self.convolutions.iter().map(|&convolution| {
            let [height, width, _] = inputs;
            let layer = Layer::convolution(inputs, convolution, self.activation);
            let layer = layer.ok_or(NetworkError::FilterTooLarge {
                size: convolution.size,
                height,
                width,
            })?;
            inputs = layer.outputs();
            Ok(layer)
        });
        layers.collect()
    }

    /// All layers before the vector joins.
    fn encoder(&self, grid: Option<[usize; 3]>) -> Result<Vec<Layer>, NetworkError> {
        let Some(grid) = grid else {
            let keys = [
                ("convolutions", self.convolutions.is_empty()),
                ("encoder_hidden", self.encoder_hidden.is_empty()),
            ];
            let unusable = keys.into_iter().find(|(_, empty)| !empty);
            return unusable.map_or(Ok(Vec::new()), |(key, _)| Err(NetworkError::NoGrid { key }));
        };
        let mut layers = self.conv_layers(grid)?;
        let flat = grid.iter().product();
        let mut inputs = layers.last().map_or(flat, Layer::output_len);
        for &width in &self.encoder_hidden {
            layers.push(Layer::dense(inputs, width, self.activation));
            inputs = width;
        }
        Ok(layers)
    }
}

fn depth(key: &'static str, layers: usize) -> Result<(), NetworkError> {
    match layers > MAX_DEPTH {
        true => Err(NetworkError::TooDeep { key, layers }),
        false => Ok(()),
    }
}

/// A layer, and where its weights `[patch][filters]`, then its biases `[filters]`, lie in the flat vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerParams {
    /// Shape of the layer.
    pub layer: Layer,
    start: usize,
}

impl LayerParams {
    /// Indices of the weights.
    pub fn weights(&self) -> Range<usize> {
        self.start..self.start + self.layer.patch() * self.layer.filters()
    }

    /// Indices of the biases.
    pub fn biases(&self) -> Range<usize> {
        let start = self.weights().end;
        start..start + self.layer.filters()
    }

    /// Indices of both.
    pub fn span(&self) -> Range<usize> {
        self.start..self.biases().end
    }
}

/// A network whose parameters lie in a flat vector.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Network {
    observation: ObservationSpec,
    /// From the input to the output; so many of them are the encoder's.
    layers: Vec<LayerParams>,
    encoder: usize,
}

impl Network {
    /// A network of those hidden layers with so many `outputs`, whose parameters begin at the index
    /// `start` of a flat vector.
    ///
    /// # Errors
    /// There can be no such network, or not for such observations.
    pub fn new(
        config: &NetworkConfig,
        observation: &ObservationSpec,
        outputs: usize,
        start: usize,
    ) -> Result<Self, NetworkError> {
        config.check()?;
        let mut layers = config.encoder(observation.grid)?;
        let encoder = layers.len();
        let maps = observation.dim() - observation.vector;
        let mut inputs = observation.vector + layers.last().map_or(maps, Layer::output_len);
        for &width in &config.hidden {
            layers.push(Layer::dense(inputs, width, config.activation));
            inputs = width;
        }
        layers.push(Layer::dense(inputs, outputs, Activation::Identity));
        let mut start = start;
        let place = |layer: Layer| {
            let params = LayerParams { layer, start };
            start = params.span().end;
            params
        };
        Ok(Network {
            observation: *observation,
            layers: layers.into_iter().map(place).collect(),
            encoder,
        })
    }

    /// What it observes.
    pub fn observation(&self) -> &ObservationSpec {
        &self.observation
    }

    /// All layers: the encoder's, then the trunk's.
    pub fn layers(&self) -> &[LayerParams] {
        &self.layers
    }

    /// Layers of the encoder.
    pub fn encoder_len(&self) -> usize {
        self.encoder
    }

    /// Whether there are layers between the maps and the trunk.
    pub fn has_map_encoder(&self) -> bool {
        self.encoder > 0
    }

    /// The convolutions over the maps.
    pub fn conv_layers(&self) -> &[LayerParams] {
        let dense = self
            .layers
            .iter()
            .position(|params| params.layer.is_dense());
        &self.layers[..dense.unwrap_or(0)]
    }

    /// Numbers of an output.
    pub fn outputs(&self) -> usize {
        self.layers.last().map_or(0, |last| last.layer.output_len())
    }

    /// Indices of all its parameters.
    pub fn span(&self) -> Range<usize> {
        let start = self.layers.first().map_or(0, |first| first.start);
        start..self.layers.last().map_or(start, |last| last.span().end)
    }

    /// Multiplications and additions for one observation.
    pub fn flops(&self) -> usize {
        self.layers.iter().map(|params| params.layer.flops()).sum()
    }
}
