//! What networks learn: a loss of each row, as a function of the networks' outputs.

use crate::gpu::{Buffer, Gpu};

/// A loss that is a sum over rows. It knows the outputs of networks, not the networks.
///
/// Beside the gradients with respect to the outputs, rows add up the extras: first the gradients of the
/// parameters that no network has (as the logarithms of standard deviations), which stand behind those of
/// the networks, then sums worth logging.
pub trait Objective: Sync {
    /// Writes the gradients of the loss over the `outputs` of a network, `[rows][outputs]`, and adds
    /// to the `extras`.
    fn loss_gradient(&self, batch: &HostBatch, outputs: &mut [f32], extras: &mut [f32]);

    /// Queues the gradients and extras of a minibatch on a GPU.
    fn launch(&self, gpu: &Gpu, batch: &GpuBatch);
}

/// Some rows of a minibatch in host memory.
pub struct HostBatch<'a> {
    /// Number of the network whose outputs these are.
    pub network: usize,
    /// Samples, observations first.
    pub rows: &'a [&'a [f32]],
    /// The flat vector.
    pub parameters: &'a [f32],
}

/// A minibatch on a GPU.
pub struct GpuBatch<'a> {
    /// Numbers of an observation; where the parameters that no network has begin; numbers of an output of
    /// every network.
    pub dims: &'a Buffer<u32>,
    /// `[..][width]`, observations first.
    pub samples: &'a Buffer<f32>,
    /// Numbers of a sample.
    pub width: usize,
    /// Samples from `first` on.
    pub first: usize,
    /// Samples of the minibatch.
    pub rows: usize,
    /// The flat vector.
    pub parameters: &'a Buffer<f32>,
    /// `[rows][outputs]` of the first network, then of the next.
    pub outputs: &'a Buffer<f32>,
    /// The gradients with respect to them, to be written.
    pub output_grads: &'a Buffer<f32>,
    /// `[rows][extras]`, to be written.
    pub extras: &'a Buffer<f32>,
}
