//! Opens environments of a task.

use super::common::Common;
use super::cpu::CpuHumanoidEnv;
use super::gpu::GpuHumanoidEnv;
use super::humanoid_task::HumanoidTask;
use crate::env::vec_env::VecEnv;
use crate::gpu::Device;
use anyhow::Result;
use std::ops::Range;
use std::sync::Arc;

/// Opens the environments `envs` of a batch: what they do depends on their numbers and `seed` alone,
/// not on who else is in this part of the batch. Their first episodes are shorter by a random part, so
/// that not all end at once.
///
/// # Errors
/// More environments than the device has room for.
pub fn open(
    device: &Device,
    task: Arc<dyn HumanoidTask>,
    envs: Range<usize>,
    seed: u32,
) -> Result<Box<dyn VecEnv>> {
    let common = Common::new(task, envs, seed);
    common.batch.check(device)?;
    let limits = common.staggered_limits();
    Ok(match device {
        Device::Cpu => Box::new(CpuHumanoidEnv::new(common, &limits)),
        Device::Gpu(gpu) => Box::new(GpuHumanoidEnv::new(common, &limits, gpu)?),
    })
}
