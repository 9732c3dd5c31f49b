//! Opens locomotion environments on a device.

use super::config::EnvConfig;
use super::cpu::CpuLocomotion;
use super::gpu::GpuLocomotion;
use crate::env::batch::EnvBatch;
use crate::env::vec_env::VecEnv;
use crate::gpu::Device;
use crate::matching::MotionMatcher;
use crate::ranks::Ranks;
use anyhow::Result;
use std::sync::Arc;

impl EnvConfig {
    /// Opens the environments of a training on `device`, all at the start of an episode.
    ///
    /// # Errors
    /// They do not fit the device.
    pub fn open(&self, device: &Device, matcher: &Arc<MotionMatcher>) -> Result<EnvBatch> {
        self.open_share(device, &Ranks::alone(), matcher)
    }

    /// Opens a rank's share of the environments of a training on `device`, all at the start of an episode.
    ///
    /// # Errors
    /// They do not fit the device.
    pub fn open_share(
        &self,
        device: &Device,
        ranks: &Ranks,
        matcher: &Arc<MotionMatcher>,
    ) -> Result<EnvBatch> {
        let curriculum = self.task.curriculum();
        EnvBatch::open(device, ranks, self.envs, curriculum, |envs| {
            let (first, jitter) = (envs.start, self.initial_age_jitter());
            let part = EnvConfig {
                envs: envs.len(),
                ..*self
            };
            Ok(match device {
                Device::Cpu => {
                    let part = CpuLocomotion::part(matcher.clone(), &part, first, jitter);
                    Box::new(part) as Box<dyn VecEnv>
                }
                Device::Gpu(gpu) => {
                    Box::new(GpuLocomotion::new(gpu, matcher, &part, first, jitter))
                }
            })
        })
    }
}
