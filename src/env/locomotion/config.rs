//! Locomotion environments to be opened.

use super::task::LocomotionTask;
use crate::env::spec::{EnvSpec, ObservationSpec};
use crate::kernels::locomotion::locomotion_layout::{BASE_OBS_DIM, CELLS, MAPS};
use crate::kernels::termination;
use crate::motion::RATE;
use crate::motion::features::{FRAMES_PER_STEP, TRAJECTORY_DIM};

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
    /// Task with its choices.
    pub task: LocomotionTask,
    /// Number of environments.
    pub envs: usize,
    /// Seed of everything random in them.
    pub seed: u32,
    /// Level of the curriculum that they begin on, from 0; the plane has none.
    pub level: u32,
}

impl EnvConfig {
    /// The dimensions of the environments.
    pub fn spec(&self) -> EnvSpec {
        let bootstrap = self.task.bootstrap();
        EnvSpec {
            envs: self.envs,
            agents: 1,
            observation: ObservationSpec {
                vector: BASE_OBS_DIM,
                grid: self.task.has_maps().then_some([CELLS, CELLS, MAPS]),
            },
            style: 0,
            action: TRAJECTORY_DIM,
            dt: STEP_S,
            bootstrap,
            bootstraps_often: bootstrap != 1 << termination::TRUNCATED,
        }
    }

    /// Steps by which the limits of the first episodes differ at most, so that on the plane not all are
    /// truncated at once.
    pub(super) fn initial_age_jitter(&self) -> u32 {
        match self.task {
            LocomotionTask::Plane(plane) => plane.max_steps,
            LocomotionTask::Obstacles(_) => 0,
        }
    }
}
