//! The discriminator's objective.

use super::DiscriminatorLoss;
use crate::gpu::Gpu;
use crate::kernels::learn::discriminator_loss::{self, Params};
use crate::nn::objective::{GpuBatch, HostBatch, Objective};

pub use crate::kernels::learn::discriminator_loss::SUMS;

/// The mean loss over samples of a window and a label, 1 of a recorded one.
pub struct TellApart {
    pub loss: DiscriminatorLoss,
    /// 1 / samples of the mean.
    pub inv_count: f32,
}

impl TellApart {
    fn params(&self) -> Params {
        Params {
            rows: 0,
            start: 0,
            width: 0,
            hinge: u32::from(self.loss == DiscriminatorLoss::Hinge),
            inv_count: self.inv_count,
        }
    }
}

impl Objective for TellApart {
    fn loss_gradient(&self, batch: &HostBatch, outputs: &mut [f32], extras: &mut [f32]) {
        discriminator_loss::rows(batch.rows, outputs, extras, &self.params());
    }

    fn launch(&self, gpu: &Gpu, batch: &GpuBatch) {
        let params = Params {
            rows: batch.rows as u32,
            start: batch.first as u32,
            width: batch.width as u32,
            ..self.params()
        };
        discriminator_loss::launch(
            gpu,
            batch.dims,
            batch.samples,
            batch.outputs,
            batch.output_grads,
            batch.extras,
            &params,
        );
    }
}
