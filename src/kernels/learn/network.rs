//! How policy and critic, all of dense layers, lie in memory while they learn on a GPU: what
//! `shaders/shared/network.wgsl` says, which [`forward`](super::forward), [`loss`](super::loss),
//! [`backward`](super::backward), [`gradient`](super::gradient), [`total`](super::reduce_grads) and
//! [`adam`](super::adam) read.

use crate::gpu::shader::gradient::constants as wgsl;
use bytemuck::{Pod, Zeroable};

/// Rows, or inputs, that an invocation computes at once.
pub const BLOCK: usize = 8;
/// Invocations of a workgroup.
pub(super) const LANES: u32 = 32;
/// The most rows: WebGPU launches no more workgroups in a dimension.
pub const ROWS: usize = BLOCK * 65_535;
/// What the loss adds up besides the gradient with respect to `log_std`: surrogate, value loss,
/// entropy, KL divergence, samples out of the clip range.
pub const SUMS: usize = 5;
/// Numbers a workgroup of `total` adds up.
pub const GROUP: usize = 64;

const _: () = assert!(
    wgsl::BLOCK as usize == BLOCK
        && wgsl::LANES == LANES
        && wgsl::SUMS as usize == SUMS
        && wgsl::GROUP as usize == GROUP
);

/// A layer.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Place {
    pub inputs: u32,
    pub outputs: u32,
    /// Where in the parameters its weights `[inputs][outputs]` begin; its biases follow.
    pub weights: u32,
    /// Columns of what comes in and goes out.
    pub below: u32,
    pub above: u32,
    /// 1: tanh of the sums. 0: the sums.
    pub bent: u32,
}

/// What does not depend on the layer.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Head {
    /// Samples.
    pub rows: u32,
    /// Numbers of a row: what is observed, once for each network, then what comes out of every layer,
    /// the actor's before the critic's, then what the loss adds up.
    pub pitch: u32,
    /// Rows are added up in so many pieces of `piece` blocks.
    pub pieces: u32,
    pub piece: u32,
    pub parameters: u32,
    /// Of `places`.
    pub count: u32,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub head: Head,
    /// Layer by layer, the actor's before the critic's; last one without inputs, for what the loss
    /// adds up: the gradient with respect to `log_std`, and [`SUMS`].
    pub places: Vec<Place>,
}

impl Plan {
    /// As shaders read it.
    pub fn words(&self) -> Vec<u32> {
        let mut words = bytemuck::cast_slice(&[self.head]).to_vec();
        words.extend_from_slice(bytemuck::cast_slice(&self.places));
        words
    }

    /// Where each parameter stands when weights are `[outputs][inputs]`.
    pub fn turned(&self) -> Vec<u32> {
        let mut turned: Vec<u32> = (0..self.head.parameters).collect();
        for place in &self.places {
            for input in 0..place.inputs {
                for output in 0..place.outputs {
                    let from = place.weights + input * place.outputs + output;
                    turned[from as usize] = place.weights + output * place.inputs + input;
                }
            }
        }
        turned
    }

    /// The same networks, and pieces of the same size, for fewer rows.
    pub fn fewer(&self, rows: usize) -> Plan {
        let mut plan = self.clone();
        plan.head.rows = rows as u32;
        plan.head.pieces = (plan.blocks() as u32).div_ceil(plan.head.piece);
        plan
    }

    /// Blocks of rows.
    pub fn blocks(&self) -> usize {
        (self.head.rows as usize).div_ceil(BLOCK)
    }

    /// Numbers of all rows, the last block filled up.
    pub fn numbers(&self) -> usize {
        self.blocks() * self.head.pitch as usize * BLOCK
    }

    /// Where among them a column of a row stands.
    pub fn at(&self, row: usize, column: usize) -> usize {
        (row / BLOCK * self.head.pitch as usize + column) * BLOCK + row % BLOCK
    }

    /// A network's layers, from below; 0 is the actor's, 1 the critic's.
    pub(super) fn layers(
        &self,
        network: usize,
    ) -> impl DoubleEndedIterator<Item = &Place> + ExactSizeIterator {
        let both = &self.places[..self.places.len() - 1];
        both[network..].iter().step_by(2)
    }
}

impl Place {
    /// Inputs, outputs, where the weights begin, columns below and above.
    pub(super) fn sizes(&self) -> [usize; 5] {
        [
            self.inputs,
            self.outputs,
            self.weights,
            self.below,
            self.above,
        ]
        .map(|size| size as usize)
    }
}
