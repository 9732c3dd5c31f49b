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
    let spec = policy.observation();
    let (mut vector, mut maps) = (vector.to_string(), maps.map(str::to_string));
    if let Some(moments) = &policy.normalizer {
        let (mean, inv_std) = (moments.mean(), moments.inv_std());
        let own = [&mean[..spec.vector], &inv_std[..spec.vector]];
        vector = normalized(
            graph,
            &vector,
            [name, ""],
            own.map(<[f32]>::to_vec),
            &[spec.vector],
        );
        if let (Some(values), Some(grid @ [height, width, channels])) = (&mut maps, spec.grid) {
            let own = [&mean[spec.vector..], &inv_std[spec.vector..]];
            let own = own.map(|own| channels_first(grid).map(|from| own[from]).collect());
            let shape = [channels, height, width];
            *values = normalized(graph, values, [name, "maps_"], own, &shape);
        }
    }
    let network = &policy.networks().actor;
    let (encoder, trunk) = network.layers().split_at(network.encoder_len());
    let (convolutions, dense) = encoder.split_at(network.conv_layers().len());
    let mut stack = Stack {
        graph,
        parameters: &policy.parameters,
        layers: Vec::new(),
    };
    let (mut value, mut columns) = (vector, Vec::from_iter(0..spec.vector));
    if let (Some(mut maps), Some(mut grid)) = (maps, spec.grid) {
        let mut numbers = 0..;
        let mut layer_name = || format!("{name}.maps.{}", numbers.next().unwrap_or_default());
        for params in convolutions {
            maps = stack.convolution(layer_name(), params, &maps);
            grid = params.layer.outputs();
        }
        maps = stack.graph.node("Flatten", &[&maps]);
        let mut order = Vec::from_iter(channels_first(grid));
        for params in dense {
            maps = stack.dense(layer_name(), params, &maps, &order);
            order = Vec::from_iter(0..params.layer.output_len());
        }
        value = stack.graph.concat(&[&value, &maps]);
        columns.extend(order.into_iter().map(|from| spec.vector + from));
    }
    let map_layers = std::mem::take(&mut stack.layers);
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

/// As [`RunningMeanStd`](crate::nn::RunningMeanStd) does it.
fn normalized(
    graph: &mut Graph,
    value: &str,
    [name, kind]: [&str; 2],
    [mean, inv_std]: [Vec<f32>; 2],
    shape: &[usize],
) -> String {
    let mean = graph.parameter(format!("{name}.{kind}mean"), shape, mean);
    let inv_std = graph.parameter(format!("{name}.{kind}inv_std"), shape, inv_std);
    let centred = graph.node("Sub", &[value, &mean]);
    let scaled = graph.node("Mul", &[&centred, &inv_std]);
    graph.clip(&scaled, CLIP)
}

/// Layers one upon another.
struct Stack<'a> {
    graph: &'a mut Graph,
    /// The flat vector of all parameters.
    parameters: &'a [f32],
    layers: Vec<LayerDescription>,
}

impl Stack<'_> {
    /// A dense layer whose inputs are footwork's in the order `columns`.
    fn dense(
        &mut self,
        name: String,
        params: &LayerParams,
        input: &str,
        columns: &[usize],
    ) -> String {
        let (weights, filters) = (&self.parameters[params.weights()], params.layer.filters());
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
        let (weights, filters) = (&self.parameters[params.weights()], layer.filters());
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
        let biases = self.parameters[params.biases()].to_vec();
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
