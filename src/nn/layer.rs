//! The shape of one layer of a network.

use serde::{Deserialize, Serialize};

/// A convolution without padding, as it is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Convolution {
    /// Filters; as many channels come out.
    pub filters: usize,
    /// Height and width of a filter, cells.
    pub size: usize,
    /// Cells between two places of a filter.
    pub stride: usize,
}

/// What a layer does to its sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Activation {
    /// `max(x, 0)`
    Relu,
    /// The hyperbolic tangent.
    Tanh,
    /// Nothing, as in the last layer of a network.
    Identity,
}

/// A valid convolution of inputs of a known shape, channels last. A dense layer is one of a single
/// pixel, whose channels are its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layer {
    inputs: [usize; 3],
    outputs: [usize; 3],
    convolution: Convolution,
    activation: Activation,
}

impl Layer {
    /// A convolution of inputs `[height, width, channels]`. None if the filters are larger than that, or
    /// anything is zero.
    pub fn convolution(
        inputs: [usize; 3],
        convolution: Convolution,
        activation: Activation,
    ) -> Option<Self> {
        let Convolution {
            filters,
            size,
            stride,
        } = convolution;
        let [height, width, channels] = inputs;
        if [filters, size, stride, channels].contains(&0) || size > height.min(width) {
            return None;
        }
        let pixels = |length: usize| (length - size) / stride + 1;
        Some(Layer {
            inputs,
            outputs: [pixels(height), pixels(width), filters],
            convolution,
            activation,
        })
    }

    /// A layer in which every output depends on every input.
    pub fn dense(inputs: usize, outputs: usize, activation: Activation) -> Self {
        Layer {
            inputs: [1, 1, inputs],
            outputs: [1, 1, outputs],
            convolution: Convolution {
                filters: outputs,
                size: 1,
                stride: 1,
            },
            activation,
        }
    }

    /// `[height, width, channels]`
    pub fn inputs(&self) -> [usize; 3] {
        self.inputs
    }

    /// `[height, width, filters]`
    pub fn outputs(&self) -> [usize; 3] {
        self.outputs
    }

    /// Numbers of an input.
    pub fn input_len(&self) -> usize {
        self.inputs.iter().product()
    }

    /// Numbers of an output.
    pub fn output_len(&self) -> usize {
        self.outputs.iter().product()
    }

    /// Whether it is a dense layer.
    pub fn is_dense(&self) -> bool {
        self.inputs[..2] == [1, 1]
    }

    /// Height and width of a filter.
    pub fn size(&self) -> usize {
        self.convolution.size
    }

    /// Cells between two places of a filter.
    pub fn stride(&self) -> usize {
        self.convolution.stride
    }

    /// What is done to the sums.
    pub fn activation(&self) -> Activation {
        self.activation
    }

    /// Number of filters, and of biases.
    pub fn filters(&self) -> usize {
        self.convolution.filters
    }

    /// Numbers that come together in an output: weights are `[patch][filters]`, a patch is
    /// `[row][column][channel]`.
    pub fn patch(&self) -> usize {
        self.size() * self.patch_row_len()
    }

    /// Numbers of a row of a patch. With channels last they are neighbours.
    pub(super) fn patch_row_len(&self) -> usize {
        self.size() * self.inputs[2]
    }

    /// Numbers of a row of the input.
    pub(super) fn row_stride(&self) -> usize {
        self.inputs[1] * self.inputs[2]
    }

    /// Index in the input of the patch of every output pixel: `[samples][height][width]`.
    pub(super) fn patch_offsets(&self, samples: usize) -> Vec<usize> {
        let mut offsets = Vec::new();
        self.patch_offsets_into(samples, &mut offsets);
        offsets
    }

    /// [`Layer::patch_offsets`] in memory that is there already.
    pub(super) fn patch_offsets_into(&self, samples: usize, offsets: &mut Vec<usize>) {
        let [rows, columns, _] = self.outputs;
        offsets.clear();
        offsets.reserve(samples * rows * columns);
        for sample in 0..samples {
            for row in 0..rows {
                let first = sample * self.input_len() + row * self.stride() * self.row_stride();
                let columns = 0..columns;
                offsets
                    .extend(columns.map(|column| first + column * self.stride() * self.inputs[2]));
            }
        }
    }

    /// Multiplications and additions for one sample.
    pub fn flops(&self) -> usize {
        2 * self.output_len() * self.patch()
    }
}
