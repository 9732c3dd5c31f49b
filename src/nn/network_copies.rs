//! Copies of one network, each with parameters of its own, evaluated together.

use super::cpu;
#[cfg(feature = "gpu")]
use super::gpu::blockwise::Blockwise;
use super::network::Network;
use crate::gpu::{Array, Device};
#[cfg(feature = "gpu")]
use crate::kernels::learn::network::BLOCK;
use crate::kernels::learn::network::NO_COPY;
use anyhow::Result;

/// Copies of one dense network, each with parameters of its own. Rows are evaluated in blocks, of which each belongs to
/// one copy: what that costs depends on the number of rows, hardly on that of copies.
pub struct NetworkCopies {
    backend: Backend,
    network: Network,
    /// Numbers of a copy.
    parameters: usize,
    rows: usize,
}

enum Backend {
    Cpu,
    #[cfg(feature = "gpu")]
    Gpu(Box<Blockwise>),
}

impl NetworkCopies {
    /// Copies of `network` on `device`, for so many rows, whole blocks of them. A copy has so many `parameters`: the
    /// network's, then any others.
    ///
    /// # Errors
    /// A layer is not dense, or the device has no room for so many rows.
    pub fn new(device: &Device, network: Network, parameters: usize, rows: usize) -> Result<Self> {
        let backend = match device {
            Device::Cpu => Backend::Cpu,
            #[cfg(feature = "gpu")]
            Device::Gpu(gpu) => {
                Backend::Gpu(Box::new(Blockwise::new(gpu, &network, parameters, rows)?))
            }
            #[cfg(not(feature = "gpu"))]
            Device::Gpu(_) => unreachable!("there is no GPU without the feature `gpu`"),
        };
        Ok(NetworkCopies {
            backend,
            network,
            parameters,
            rows,
        })
    }

    /// Rows of a block on a device.
    pub fn block(device: &Device) -> usize {
        match device {
            Device::Cpu => 1,
            #[cfg(feature = "gpu")]
            Device::Gpu(_) => BLOCK,
            #[cfg(not(feature = "gpu"))]
            Device::Gpu(_) => unreachable!("there is no GPU without the feature `gpu`"),
        }
    }

    /// Writes the outputs `[rows][outputs]` for `observations`, `[rows][observation]`, to `out`. `copies` has, for every
    /// block, the number of the copy that evaluates it, of `parameters`, `[copies][parameters]`; or
    /// [`NO_COPY`], and its outputs are left as they are.
    pub fn forward(
        &self,
        parameters: &Array,
        copies: &Array<u32>,
        observations: &Array,
        out: &mut Array,
    ) {
        match &self.backend {
            Backend::Cpu => self.forward_on_host(
                parameters.host(),
                copies.host(),
                observations.host(),
                out.host_mut(),
            ),
            #[cfg(feature = "gpu")]
            Backend::Gpu(copied) => copied.forward(parameters, copies, observations, out),
        }
    }

    /// Takes the rows of a copy that follow each other together.
    fn forward_on_host(
        &self,
        parameters: &[f32],
        copies: &[u32],
        observations: &[f32],
        out: &mut [f32],
    ) {
        let (width, outputs) = (observations.len() / self.rows, out.len() / self.rows);
        let mut row = 0;
        for run in copies.chunk_by(|one, next| one == next) {
            if run[0] != NO_COPY {
                let parameters =
                    &parameters[run[0] as usize * self.parameters..][..self.parameters];
                let observations = &observations[row * width..][..run.len() * width];
                let out = &mut out[row * outputs..][..run.len() * outputs];
                cpu::forward(&self.network, parameters, observations, out);
            }
            row += run.len();
        }
    }
}
