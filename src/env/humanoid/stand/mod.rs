//! The task `stand`: stay upright for ten seconds from a random pose near standing, while pushed.
//!
//! [`Stand`] are its choices, [`open`] opens a batch on either device, [`spec`] says its dimensions and
//! [`evaluate`](evaluate::evaluate) judges a policy.

mod common;
mod cpu;
pub mod evaluate;
mod gpu;
mod task;

use crate::env::vec_env::VecEnv;
use crate::gpu::Device;
use anyhow::Result;
use common::Common;
use cpu::CpuStand;
use gpu::GpuStand;
use std::ops::Range;
pub use task::{DT, Stand, spec};

/// Opens the environments `envs` of a batch: what they do depends on their numbers and `seed` alone,
/// not on who else is in this part of the batch. Their first episodes are shorter by a random part, so
/// that not all end at once.
///
/// # Errors
/// More environments than the device has room for.
///
/// ```
/// use footwork::env::Transition;
/// use footwork::env::humanoid::stand::{Stand, open};
/// use footwork::gpu::{Array, Device};
///
/// let mut envs = open(&Device::Cpu, &Stand::default(), 0..8, 1)?;
/// let (spec, rest) = (*envs.spec(), envs.rest_action());
/// let action = Array::Host(rest.repeat(spec.rows()));
/// let mut observation = Array::zeroed(&Device::Cpu, spec.rows() * spec.observation.dim());
/// let mut final_observation = observation.clone();
/// let mut reward = Array::zeroed(&Device::Cpu, spec.rows());
/// let mut termination = Array::zeroed(&Device::Cpu, spec.rows());
/// for _ in 0..5 {
///     let out = Transition {
///         step: 0,
///         reward: &mut reward,
///         termination: &mut termination,
///         final_observation: &mut final_observation,
///     };
///     envs.step(&action, 0, out);
/// }
/// envs.observe(&mut observation, 0);
/// assert!(reward.host().iter().all(|&reward| reward > 0.0));
/// # Ok::<(), anyhow::Error>(())
/// ```
pub fn open(
    device: &Device,
    stand: &Stand,
    envs: Range<usize>,
    seed: u32,
) -> Result<Box<dyn VecEnv>> {
    let common = Common::new(stand, envs, seed);
    common.batch.check(device)?;
    let limits = common.staggered_limits();
    Ok(match device {
        Device::Cpu => Box::new(CpuStand::new(common, &limits)),
        Device::Gpu(gpu) => Box::new(GpuStand::new(common, &limits, gpu)?),
    })
}
