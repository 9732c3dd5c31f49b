//! A dense network whose parameters differ from block to block of rows: one launch for all layers and all copies.

use super::fused::{Layout, dense};
use crate::gpu::{Array, Buffer, Device, Gpu};
use crate::kernels::learn::forward;
use crate::kernels::learn::network::{BatchLayout, MAX_ROWS};
use crate::nn::network::Network;
use anyhow::{Result, bail};

/// What it needs on the device, made once.
pub struct Blockwise {
    gpu: Gpu,
    layout: Layout,
    /// Activations of all rows.
    rows: Buffer<f32>,
}

impl Blockwise {
    /// For so many rows, of copies that have so many `parameters` each.
    ///
    /// # Errors
    /// A layer is not dense, or there are more rows than the device has room for.
    pub fn new(gpu: &Gpu, network: &Network, parameters: usize, rows: usize) -> Result<Self> {
        let layers = dense(network);
        let layout = layers.and_then(|layers| BatchLayout::new(&[layers], parameters, 0, rows));
        let Some(layout) = layout else {
            bail!("copies of a network have dense layers alone");
        };
        if rows > MAX_ROWS {
            bail!("at most {MAX_ROWS} rows are evaluated by copies of a network");
        }
        let device = Device::from(gpu.clone());
        device.holds("activations of copies of a network", layout.numbers())?;
        Ok(Blockwise {
            rows: Buffer::empty(gpu, layout.numbers()),
            layout: Layout::new(gpu, layout),
            gpu: gpu.clone(),
        })
    }

    /// See [`NetworkCopies::forward`](crate::nn::NetworkCopies::forward).
    pub fn forward(
        &self,
        parameters: &Array,
        copies: &Array<u32>,
        observations: &Array,
        out: &mut Array,
    ) {
        let rows = self.layout.host.head.rows;
        let params = forward::Params {
            rows,
            start: 0,
            width: (observations.len() / rows as usize) as u32,
            network: 0,
            out_at: 0,
        };
        forward::launch(
            &self.gpu,
            1,
            &self.layout.table,
            observations.buffer(),
            parameters.buffer(),
            copies.buffer(),
            &self.rows,
            out.buffer(),
            &params,
        );
    }
}
