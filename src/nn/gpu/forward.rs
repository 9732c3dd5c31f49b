//! Answers to observations, a launch each.

use crate::nn::network::Shape;
use super::plan;
use crate::gpu::tensor::{from_buffer, to_buffer};
use crate::gpu::{Buffer, Device, Gpu};
use crate::kernels::learn::forward;
use burn::tensor::Tensor;

/// Rows on their way through the layers at once, at most: 13 MB in networks like the presets'.
const AT_ONCE: usize = 1 << 14;

/// What answering needs on the device, made once.
pub struct Answering {
    gpu: Gpu,
    table: Buffer<u32>,
    rows: Buffer<f32>,
    /// There is room for.
    most: usize,
}

impl Answering {
    /// To so many observations at once, if there are more than [`AT_ONCE`] one part after the other. None if a
    /// layer is not dense, or the rows too large for the device.
    pub fn new(gpu: &Gpu, shape: &Shape, observations: usize) -> Option<Self> {
        let most = observations.min(AT_ONCE);
        let plan = plan(shape, most)?;
        Device::from(gpu.clone())
            .holds("rows", plan.numbers())
            .ok()?;
        Some(Answering {
            table: Buffer::from_slice(gpu, &plan.words()),
            rows: Buffer::zeroed(gpu, plan.numbers()),
            gpu: gpu.clone(),
            most,
        })
    }

    /// Of the actor (0) or the critic (1), `[n, answers]`, for observations `[n, width]`.
    pub fn answer(
        &self,
        network: u32,
        answers: usize,
        parameters: &Buffer<f32>,
        observation: Tensor<2>,
    ) -> Tensor<2> {
        let [samples, width] = observation.dims();
        let observation = to_buffer(observation);
        let part = |start: usize| {
            let rows = self.most.min(samples - start);
            let answered = Buffer::empty(&self.gpu, rows * answers);
            let params = forward::Params {
                rows: rows as u32,
                start: start as u32,
                width: width as u32,
                first: network,
            };
            forward::launch(
                &self.gpu,
                1,
                &self.table,
                &observation,
                parameters,
                &self.rows,
                &answered,
                &params,
            );
            from_buffer(&self.gpu, &answered, [rows, answers])
        };
        match samples <= self.most {
            true => part(0),
            false => Tensor::cat((0..samples).step_by(self.most).map(part).collect(), 0),
        }
    }
}
