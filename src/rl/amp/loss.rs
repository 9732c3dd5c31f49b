//! The discriminator's objective.

use super::DiscriminatorLoss;
use crate::gpu::Gpu;
use crate::kernels::learn::discriminator_loss::{self, Params};
use crate::kernels::learn::encoder_loss;
use crate::nn::objective::{GpuBatch, HostBatch, Objective};

pub use crate::kernels::learn::discriminator_loss::{COSINE, SUMS};

/// The mean loss over samples of a window, a label, 1 of a recorded one, and the latent that an encoder is to
/// find in the window.
pub struct TellApart {
    pub loss: DiscriminatorLoss,
    /// Numbers of a window.
    pub window: usize,
    /// Outputs that tell apart; those behind them are the encoder's.
    pub heads: usize,
    /// Numbers of a latent: 0 if there is no encoder.
    pub latent: usize,
    /// 1 / samples of the mean.
    pub inv_count: f32,
    /// 1 / samples that have a latent.
    pub inv_latents: f32,
}

impl TellApart {
    fn params(&self) -> Params {
        Params {
            rows: 0,
            start: 0,
            width: 0,
            hinge: u32::from(self.loss == DiscriminatorLoss::Hinge),
            heads: self.heads as u32,
            inv_count: self.inv_count,
        }
    }

    fn encoder_params(&self) -> encoder_loss::Params {
        encoder_loss::Params {
            rows: 0,
            start: 0,
            width: 0,
            heads: self.heads as u32,
            weight: self.inv_latents,
        }
    }
}

impl Objective for TellApart {
    fn loss_gradient(&self, batch: &HostBatch, outputs: &mut [f32], extras: &mut [f32]) {
        discriminator_loss::rows(batch.rows, self.window, outputs, extras, &self.params());
        if self.latent > 0 {
            encoder_loss::rows(batch.rows, outputs, extras, &self.encoder_params());
        }
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
        if self.latent > 0 {
            let params = encoder_loss::Params {
                rows: params.rows,
                start: params.start,
                width: params.width,
                ..self.encoder_params()
            };
            encoder_loss::launch(
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
}
