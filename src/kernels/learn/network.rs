//! How networks of dense layers, and a batch of rows on its way through them, lie in memory on a GPU: what
//! `shaders/shared/network.wgsl` says, which [`forward`](super::forward), [`backward`](super::backward),
//! [`gradient`](super::gradient) and [`reduce_grads`](super::reduce_grads) read.

use crate::gpu::shader::forward::constants as wgsl;
use bytemuck::{Pod, Zeroable};

/// Rows, or inputs, that an invocation computes at once.
pub const BLOCK: usize = 8;
/// Invocations of a workgroup.
pub(super) const LANES: u32 = 32;
/// The most rows: WebGPU launches no more workgroups in a dimension.
pub const MAX_ROWS: usize = BLOCK * 65_535;
/// The most networks.
pub const MAX_NETWORKS: usize = 4;

/// Blocks of a split, and the most splits, of a gradient.
const SPLIT_BLOCKS: usize = 8;
const MAX_SPLITS: usize = 64;
/// The most numbers of all splits' gradients together (16 MiB), but for the one that there must be.
const MAX_PARTIALS: usize = 1 << 22;

const _: () = assert!(wgsl::BLOCK as usize == BLOCK && wgsl::LANES == LANES);

/// Activation that leaves the sums as they are.
pub const IDENTITY: u32 = wgsl::IDENTITY;
/// Activation that replaces negative sums by zero.
pub const RELU: u32 = wgsl::RELU;
/// Activation by the hyperbolic tangent.
pub const TANH: u32 = wgsl::TANH;

/// Number of no copy of the parameters: rows that are not evaluated.
pub const NO_COPY: u32 = wgsl::NO_COPY;

/// A dense layer.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct LayerWords {
    /// Number of inputs.
    pub inputs: u32,
    /// Number of outputs.
    pub outputs: u32,
    /// Where in the parameters its weights `[inputs][outputs]` begin; its biases follow.
    pub weights: u32,
    /// Column of a row where the inputs begin.
    pub input_col: u32,
    /// Column of a row where the outputs begin.
    pub output_col: u32,
    /// [`IDENTITY`], [`RELU`] or [`TANH`].
    pub activation: u32,
}

/// What does not depend on the layer.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct BatchHead {
    /// Rows of the batch.
    pub rows: u32,
    /// Numbers of a row: the observation, once for each network, then the outputs of every layer, then
    /// the extras.
    pub row_stride: u32,
    /// Parts over which gradients are summed, each by itself.
    pub splits: u32,
    /// Blocks of a part; the last may have fewer.
    pub split_blocks: u32,
    /// Number of parameters: those of the networks, and those behind them.
    pub parameters: u32,
    /// Sums of the objective.
    pub sums: u32,
    /// Number of networks.
    pub networks: u32,
    /// Layers of all networks, and one without inputs: the extras.
    pub layers: u32,
    /// The first layer of each network, and of the one behind the last.
    pub first_layer: [u32; MAX_NETWORKS + 1],
    /// Outputs of the networks before each.
    pub outputs_before: [u32; MAX_NETWORKS + 1],
}

/// Networks, and so many rows, on a GPU.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchLayout {
    /// What all layers share.
    pub head: BatchHead,
    /// The layers of one network after those of another; last one without inputs for the extras: the
    /// gradients of the parameters behind the networks', then the objective's sums.
    pub layers: Vec<LayerWords>,
}

impl BatchLayout {
    /// The layout of networks given by their layers, each as inputs, outputs and activation; their parameters lie
    /// one after another, and `parameters` are all there are. None for too many networks.
    pub fn new(
        networks: &[Vec<(usize, usize, u32)>],
        parameters: usize,
        sums: usize,
        rows: usize,
    ) -> Option<Self> {
        if networks.len() > MAX_NETWORKS {
            return None;
        }
        let (mut first_layer, mut outputs_before) = ([0; MAX_NETWORKS + 1], [0; MAX_NETWORKS + 1]);
        let (mut layers, mut column, mut weights) = (Vec::new(), 0, 0);
        for (network, list) in networks.iter().enumerate() {
            let mut input_col = column;
            column += list.first().map_or(0, |&(inputs, ..)| inputs);
            for &(inputs, outputs, activation) in list {
                layers.push(LayerWords {
                    inputs: inputs as u32,
                    outputs: outputs as u32,
                    weights: weights as u32,
                    input_col: input_col as u32,
                    output_col: column as u32,
                    activation,
                });
                weights += (inputs + 1) * outputs;
                input_col = column;
                column += outputs;
            }
            first_layer[network + 1] = layers.len() as u32;
            let outputs = list.last().map_or(0, |&(_, outputs, _)| outputs);
            outputs_before[network + 1] = outputs_before[network] + outputs as u32;
        }
        let extras = parameters - weights + sums;
        layers.push(LayerWords {
            inputs: 0,
            outputs: extras as u32,
            weights: weights as u32,
            input_col: 0,
            output_col: column as u32,
            activation: IDENTITY,
        });
        let head = BatchHead {
            rows: 0,
            row_stride: (column + extras) as u32,
            splits: 0,
            split_blocks: 0,
            parameters: parameters as u32,
            sums: sums as u32,
            networks: networks.len() as u32,
            layers: layers.len() as u32,
            first_layer,
            outputs_before,
        };
        Some(BatchLayout { head, layers }.with_rows(rows))
    }

    /// A layout of these networks for so many rows.
    pub fn with_rows(mut self, rows: usize) -> Self {
        let numbers = (self.head.parameters + self.head.sums) as usize;
        let splits = (MAX_PARTIALS / numbers.max(1)).clamp(1, MAX_SPLITS);
        self.head.rows = rows as u32;
        let blocks = self.blocks();
        let split_blocks = blocks.div_ceil(splits).next_multiple_of(SPLIT_BLOCKS);
        self.head.split_blocks = split_blocks as u32;
        self.head.splits = blocks.div_ceil(split_blocks) as u32;
        self
    }

    /// As shaders read it.
    pub fn words(&self) -> Vec<u32> {
        let mut words = bytemuck::cast_slice(&[self.head]).to_vec();
        words.extend_from_slice(bytemuck::cast_slice(&self.layers));
        words
    }

    /// Blocks of rows.
    pub fn blocks(&self) -> usize {
        (self.head.rows as usize).div_ceil(BLOCK)
    }

    /// Numbers of all rows, the last block filled up.
    pub fn numbers(&self) -> usize {
        self.blocks() * self.head.row_stride as usize * BLOCK
    }

    /// Numbers of all splits' gradients and sums.
    pub fn partials(&self) -> usize {
        self.head.splits as usize * (self.head.parameters + self.head.sums) as usize
    }

    /// Index of a column of a row among all numbers.
    pub fn at(&self, row: usize, column: usize) -> usize {
        (row / BLOCK * self.head.row_stride as usize + column) * BLOCK + row % BLOCK
    }

    /// A network's layers, from the first.
    pub fn network(&self, network: usize) -> &[LayerWords] {
        let [first, end] = [network, network + 1].map(|n| self.head.first_layer[n] as usize);
        &self.layers[first..end]
    }

    /// Outputs of the networks `from..to`.
    pub fn outputs(&self, from: usize, to: usize) -> usize {
        (self.head.outputs_before[to] - self.head.outputs_before[from]) as usize
    }

    /// The extras' pseudo-layer.
    pub fn extras(&self) -> &LayerWords {
        &self.layers[self.layers.len() - 1]
    }
}

impl LayerWords {
    /// Inputs, outputs, where the weights begin, columns of inputs and outputs.
    pub fn sizes(&self) -> [usize; 5] {
        [
            self.inputs,
            self.outputs,
            self.weights,
            self.input_col,
            self.output_col,
        ]
        .map(|size| size as usize)
    }
}
