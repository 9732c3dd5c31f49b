//! A policy's network as a graph: normalisation, convolutions, dense layers.
//!
//! Parameters have the names, shapes and order of PyTorch's layers: weights `[out, in]` of dense layers,
//! `[filters, channels, height, width]` of convolutions, of maps `[channels, height, width]`. Footwork keeps
//! channels last, so the columns of a dense layer behind maps are put in that order.

use super::graph::{Attribute, Graph};
use crate::nn::Policy;
use crate::nn::layer::{Activation, Layer};
use crate::nn::network::LayerParams;
use crate::nn::running_mean_std::CLIP;
use serde::Serialize;

/// What a network is made of, for those who evaluate it from its parameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NetworkDescription {
    /// How the names of its parameters begin.
    pub name: String,
    /// Inputs are, less `NAME.mean`, times `NAME.inv_std`, limited to this on both sides; absent if they are taken as
    /// they are. Maps have a `NAME.maps_mean` and a `NAME.maps_inv_std` of their own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clip: Option<f32>,
    /// Layers over the maps, whose output, row by row, joins the vector behind it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub maps: Vec<LayerDescription>,
    /// Layers over the vector.
    pub layers: Vec<LayerDescription>,
}

/// A layer of a network.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayerDescription {
    /// Its parameters are `NAME.weight` and `NAME.bias`.
    pub name: String,
    /// `dense` or `convolution`.
    pub kind: &'static str,
    /// Cells between two places of a convolution's filter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stride: Option<usize>,
    /// What is done to its sums.
    pub activation: Activation,
}

/// Adds a policy's actor over a value of its vector and, if it has maps, one of these,
/// `[channels, height, width]`. Returns the name of its output.
pub fn actor(
    graph: &mut Graph,
    name: &str,
    policy: &Policy,
    vector: &str,
    maps: Option<&str>,
) -> (String, NetworkDescription) {
    let (spec, network) = (policy.observation(), &policy.networks().actor);
    let mut stack = Stack {
        graph,
        name,
        policy,
        layers: Vec::new(),
    };
    let mut value = stack.normalized_vector(vector);
    let mut columns = Vec::from_iter(0..spec.vector);
    if let (Some(maps), Some(grid)) = (maps, spec.grid) {
        let maps = stack.normalized_maps(maps, grid);
        let (encoded, order) = stack.encoded(maps, grid);
        value = stack.graph.concat(&[&value, &encoded]);
        columns.extend(order.into_iter().map(|from| spec.vector + from));
    }
    let map_layers = std::mem::take(&mut stack.layers);
    let trunk = &network.layers()[network.encoder_len()..];
    for (number, params) in trunk.iter().enumerate() {
        value = stack.dense(format!("{name}.layers.{number}"), params, &value, &columns);
        columns = Vec::from_iter(0..params.layer.output_len());
    }
    let description = NetworkDescription {
        name: name.to_string(),
        clip: policy.normalizer.is_some().then_some(CLIP),
        maps: map_layers,
        layers: stack.layers,
    };
    (value, description)
}

/// Indices of numbers `[height, width, channels]` in the order `[channels, height, width]`.
pub fn channels_first([height, width, channels]: [usize; 3]) -> impl Iterator<Item = usize> {
    (0..channels)
        .flat_map(move |channel| (0..height * width).map(move |cell| cell * channels + channel))
}

/// Layers one upon another.
struct Stack<'a> {
    graph: &'a mut Graph,
    /// How the names of parameters begin.
    name: &'a str,
    policy: &'a Policy,
    layers: Vec<LayerDescription>,
}

impl Stack<'_> {
    fn normalized_vector(&mut self, value: &str) -> String {
        let width = self.policy.observation().vector;
        self.normalized(value, "", &[width], &Vec::from_iter(0..width))
    }

    fn normalized_maps(&mut self, value: &str, grid: [usize; 3]) -> String {
        let [height, width, channels] = grid;
        let first = self.policy.observation().vector;
        let columns = channels_first(grid).map(|from| first + from);
        let shape = [channels, height, width];
        self.normalized(value, "maps_", &shape, &Vec::from_iter(columns))
    }

    /// Some columns of the observation as [`RunningMeanStd`](crate::nn::RunningMeanStd) normalises them.
    fn normalized(
        &mut self,
        value: &str,
        kind: &str,
        shape: &[usize],
        columns: &[usize],
    ) -> String {
        let Some(moments) = &self.policy.normalizer else {
            return value.to_string();
        };
        let [mean, inv_std] =
            [("mean", moments.mean()), ("inv_std", &moments.inv_std())].map(|(moment, numbers)| {
                let own = columns.iter().map(|&column| numbers[column]).collect();
                let name = format!("{}.{kind}{moment}", self.name);
                self.graph.parameter(name, shape, own)
            });
        let centred = self.graph.node("Sub", &[value, &mean]);
        let scaled = self.graph.node("Mul", &[&centred, &inv_std]);
        self.graph.clip(&scaled, CLIP)
    }

    /// What the encoder makes of maps, as rows, and in which order footwork has their numbers.
    fn encoded(&mut self, maps: String, grid: [usize; 3]) -> (String, Vec<usize>) {
        let network = &self.policy.networks().actor;
        let encoder = &network.layers()[..network.encoder_len()];
        let (convolutions, dense) = encoder.split_at(network.conv_layers().len());
        let begin = format!("{}.maps", self.name);
        let (mut value, mut grid) = (maps, grid);
        for (number, params) in convolutions.iter().enumerate() {
            value = self.convolution(format!("{begin}.{number}"), params, &value);
            grid = params.layer.outputs();
        }
        value = self.graph.node("Flatten", &[&value]);
        let mut order = Vec::from_iter(channels_first(grid));
        for (number, params) in (convolutions.len()..).zip(dense) {
            value = self.dense(format!("{begin}.{number}"), params, &value, &order);
            order = Vec::from_iter(0..params.layer.output_len());
        }
        (value, order)
    }

    /// A dense layer whose inputs are footwork's in the order `columns`.
    fn dense(
        &mut self,
        name: String,
        params: &LayerParams,
        input: &str,
        columns: &[usize],
    ) -> String {
        let (weights, filters) = (
            &self.policy.parameters[params.weights()],
            params.layer.filters(),
        );
        let rows =
            (0..filters).flat_map(|out| columns.iter().map(move |from| from * filters + out));
        let values = rows.map(|at| weights[at]).collect();
        let (weight, bias) = self.parameters_of(&name, params, &[filters, columns.len()], values);
        let transposed = vec![("transB", Attribute::Int(1))];
        let sums = self
            .graph
            .node_with("Gemm", &[input, &weight, &bias], transposed);
        self.activated(name, params, sums)
    }

    fn convolution(&mut self, name: String, params: &LayerParams, input: &str) -> String {
        let layer = &params.layer;
        let (weights, filters) = (&self.policy.parameters[params.weights()], layer.filters());
        let (size, channels) = (layer.size(), layer.inputs()[2]);
        let patch = || channels_first([size, size, channels]);
        let rows = (0..filters).flat_map(|filter| patch().map(move |from| from * filters + filter));
        let values = rows.map(|at| weights[at]).collect();
        let shape = [filters, channels, size, size];
        let (weight, bias) = self.parameters_of(&name, params, &shape, values);
        let pair = |number: usize| Attribute::Ints(vec![number as i64; 2]);
        let attributes = vec![
            ("kernel_shape", pair(size)),
            ("strides", pair(layer.stride())),
        ];
        let sums = self
            .graph
            .node_with("Conv", &[input, &weight, &bias], attributes);
        self.activated(name, params, sums)
    }

    fn parameters_of(
        &mut self,
        name: &str,
        params: &LayerParams,
        shape: &[usize],
        weights: Vec<f32>,
    ) -> (String, String) {
        let biases = self.policy.parameters[params.biases()].to_vec();
        let filters = [biases.len()];
        (
            self.graph
                .parameter(format!("{name}.weight"), shape, weights),
            self.graph
                .parameter(format!("{name}.bias"), &filters, biases),
        )
    }

    fn activated(&mut self, name: String, params: &LayerParams, sums: String) -> String {
        let layer = &params.layer;
        self.layers.push(description(name, layer));
        match layer.activation() {
            Activation::Relu => self.graph.node("Relu", &[&sums]),
            Activation::Tanh => self.graph.node("Tanh", &[&sums]),
            Activation::Identity => sums,
        }
    }
}

fn description(name: String, layer: &Layer) -> LayerDescription {
    let (kind, stride) = match layer.is_dense() {
        true => ("dense", None),
        false => ("convolution", Some(layer.stride())),
    };
    LayerDescription {
        name,
        kind,
        stride,
        activation: layer.activation(),
    }
}
