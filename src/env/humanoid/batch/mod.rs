//! Thousands of independent physical worlds side by side, by shaders on a GPU or by their twins'
//! functions on all cores, without any task.
//!
//! An action lasts 1/30 s, four steps of the physics at 120 Hz. Arrays are `[field][envs]`.

mod config;
mod cpu;
mod gpu;
mod simulator_batch;

use crate::gpu::Device;
use anyhow::Result;
pub use config::{MAX_SPEED, SimulatorBatchConfig};
pub use cpu::{CpuSimulatorBatch, SimulatedWorld};
pub use gpu::{GpuSimulatorBatch, StepLaunch};
pub use simulator_batch::{ContactCounters, SimulatorBatch, overflow_warning};

/// Opens a batch on a device.
///
/// # Errors
/// A model, or a number of worlds, too large for the device.
pub fn open(device: &Device, config: &SimulatorBatchConfig) -> Result<Box<dyn SimulatorBatch>> {
    config.check(device)?;
    Ok(match device {
        Device::Cpu => Box::new(CpuSimulatorBatch::new(config)),
        Device::Gpu(gpu) => Box::new(GpuSimulatorBatch::new(config, gpu)?),
    })
}
