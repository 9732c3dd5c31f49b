//! The shape of one layer of a network.

use serde::{Deserialize, Serialize};

/// What a convolution is asked to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Convolution {
    pub filters: usize,
    /// Height and width of a filter.
    pub size: usize,
    pub stride: usize,
}

/// What a layer does to its sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bend {
    Relu,
    Tanh,
    /// Nothing: a network's answer.
    None,
}

/// A valid convolution of inputs of a known shape, channels last. A dense layer is one of a single
/// place, whose channels are its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layer {
    inputs: [usize; 3],
    outputs: [usize; 3],
    convolution: Convolution,
    bend: Bend,
}

impl Layer {
    /// Of inputs `[height, width, channels]`. None if the filters are larger than that, or anything
    /// is zero.
    pub fn convolution(inputs: [usize; 3], convolution: Convolution, bend: Bend) -> Option<Self> {
        let Convolution {
            filters,
            size,
            stride,
        } = convolution;
        let [height, width, channels] = inputs;
        if [filters, size, stride, channels].contains(&0) || size > height.min(width) {
            return None;
        }
        let places = |length: usize| (length - size) / stride + 1;
        Some(Layer {
            inputs,
            outputs: [places(height), places(width), filters],
            convolution,
            bend,
        })
    }

    pub fn dense(inputs: usize, outputs: usize, bend: Bend) -> Self {
        Layer {
            inputs: [1, 1, inputs],
            outputs: [1, 1, outputs],
            convolution: Convolution {
                filters: outputs,
                size: 1,
                stride: 1,
            },
            bend,
        }
    }

    /// `[height, width, channels]`.
    pub fn inputs(&self) -> [usize; 3] {
        self.inputs
    }

    /// `[height, width, filters]`.
    pub fn outputs(&self) -> [usize; 3] {
        self.outputs
    }

    pub fn is_dense(&self) -> bool {
        self.inputs[..2] == [1, 1]
    }

    /// Height and width of a filter.
    pub fn size(&self) -> usize {
        self.convolution.size
    }

    pub fn stride(&self) -> usize {
        self.convolution.stride
    }

    pub fn bend(&self) -> Bend {
        self.bend
    }

    /// How many; as many biases.
    pub fn filters(&self) -> usize {
        self.convolution.filters
    }

    /// Numbers that come together in an output: weights are `[patch][filters]`, a patch is
    /// `[row][column][channel]`.
    pub fn patch(&self) -> usize {
        self.size() * self.run()
    }

    /// Floats of a row of a patch. With channels last they are neighbours.
    pub(super) fn run(&self) -> usize {
        self.size() * self.inputs[2]
    }

    /// Floats of a row of the input.
    pub(super) fn pitch(&self) -> usize {
        self.inputs[1] * self.inputs[2]
    }

    /// Where in the input the patch of every output pixel starts: `[samples][height][width]`.
    pub(super) fn starts(&self, samples: usize) -> Vec<usize> {
        let [rows, columns, _] = self.outputs;
        let mut starts = Vec::with_capacity(samples * rows * columns);
        for sample in 0..samples {
            for row in 0..rows {
                let first = sample * floats(self.inputs) + row * self.stride() * self.pitch();
                let places = 0..columns;
                starts.extend(places.map(|column| first + column * self.stride() * self.inputs[2]));
            }
        }
        starts
    }

    /// Multiplications and additions for one sample.
    pub fn operations(&self) -> usize {
        2 * floats(self.outputs) * self.patch()
    }
}

/// Numbers of something of that shape.
pub fn floats(shape: [usize; 3]) -> usize {
    shape.iter().product()
}
