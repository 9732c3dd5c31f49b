//! The motion-matching tasks: reach a target, on an empty plane or among moving obstacles.
//!
//! [`task`] holds what may be chosen about them, [`kernel_params`] turns it into the kernels'
//! parameters; [`gpu`] and [`cpu`] step environments by the shaders or by their twins.

pub mod cpu;
pub mod env_state;
pub mod gpu;
pub mod kernel_params;
pub mod live_view;
pub mod task;

use super::{EnvBatch, EnvSpec, ObservationSpec, VecEnv};
use crate::gpu::Device;
use crate::kernels::locomotion::locomotion_layout::{BASE_OBS_DIM, CELLS, MAPS};
use crate::matching::MotionMatcher;
use crate::motion::RATE;
use crate::motion::features::{FRAMES_PER_STEP, TRAJECTORY_DIM};
use anyhow::Result;
pub use cpu::CpuLocomotion;
pub use env_state::EnvState;
use std::sync::Arc;
pub use task::{LEVELS, LocomotionTask, Obstacles, Plane};

/// Length of a step, s.
pub const STEP_S: f32 = FRAMES_PER_STEP as f32 / RATE;

/// Names of what the kernel `episode_stats` sums up, in its order.
pub const STAT_NAMES: [&str; 6] = [
    "episodes",
    "successes",
    "collision",
    "truncation",
    "steps",
    "returns",
];

/// Environments to be opened.
#[derive(Clone, Copy, Debug)]
pub struct EnvConfig {
    pub task: LocomotionTask,
    pub envs: usize,
    pub seed: u32,
    pub level: u32,
}

impl EnvConfig {
    /// Their dimensions.
    pub fn spec(&self) -> EnvSpec {
        let bootstrap = self.task.bootstrap();
        EnvSpec {
            envs: self.envs,
            agents: 1,
            observation: ObservationSpec {
                vector: BASE_OBS_DIM,
                grid: self.task.has_maps().then_some([CELLS, CELLS, MAPS]),
            },
            action: TRAJECTORY_DIM,
            dt: STEP_S,
            bootstrap,
            bootstraps_often: bootstrap != 1 << super::termination::TRUNCATED,
        }
    }

    /// Steps by which the limits of the first episodes differ at most, so that on the plane not all are
    /// truncated at once.
    fn initial_age_jitter(&self) -> u32 {
        match self.task {
            LocomotionTask::Plane(plane) => plane.max_steps,
            LocomotionTask::Obstacles(_) => 0,
        }
    }

    /// Opens the environments of a training on `device`, all at the start of an episode.
    ///
    /// # Errors
    /// They do not fit the device.
    pub fn open(&self, device: &Device, matcher: &Arc<MotionMatcher>) -> Result<EnvBatch> {
        let curriculum = self.task.curriculum();
        EnvBatch::open(device, self.envs, curriculum, |envs| {
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
                Device::Gpu(gpu) => Box::new(gpu::GpuLocomotion::new(gpu, matcher, &part, jitter)),
            })
        })
    }
}
