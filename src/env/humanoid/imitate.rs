//! The task `imitate`: move as recordings do. There is no reward but that of the style.
//!
//! [`ImitateTask`] begins episodes in recorded moments; [`evaluate`] compares what a policy does with the
//! recordings.

use super::driver::{BodyDriver, DriverState};
use super::fidelity::{FidelityProbe, FidelityReport};
use super::recorded::{mean_action, start_states};
use super::task::play::play_episodes;
use super::task::{COMMON_STATS, CpuHumanoidEnv, EpisodeRules, GpuHumanoidTask, HumanoidTask};
use crate::gpu::Gpu;
use crate::physics::model::Model;
use crate::physics::motion_library::MotionLibrary;
use std::sync::Arc;

/// The task with what is to be imitated.
pub struct ImitateTask {
    rules: EpisodeRules,
    library: Arc<MotionLibrary>,
    start_states: Vec<f32>,
}

impl ImitateTask {
    /// The task, with start states that depend on `seed`.
    pub fn new(rules: &EpisodeRules, library: &Arc<MotionLibrary>, seed: u32) -> ImitateTask {
        ImitateTask {
            rules: *rules,
            start_states: start_states(library, seed),
            library: library.clone(),
        }
    }
}

impl HumanoidTask for ImitateTask {
    fn model(&self) -> &Arc<Model> {
        self.library.model()
    }

    fn rules(&self) -> &EpisodeRules {
        &self.rules
    }

    fn start_states(&self) -> &[f32] {
        &self.start_states
    }

    fn rest_action(&self) -> Vec<f32> {
        mean_action(&self.library)
    }

    fn stat_names(&self) -> &'static [&'static str] {
        &COMMON_STATS
    }

    fn on_gpu(&self, _: &Gpu) -> Box<dyn GpuHumanoidTask> {
        Box::new(GpuImitate)
    }
}

struct GpuImitate;

impl GpuHumanoidTask for GpuImitate {}

/// Plays `episodes` episodes, whose starts depend on `seed` alone.
pub fn evaluate(
    task: Arc<ImitateTask>,
    driver: &dyn BodyDriver,
    episodes: usize,
    seed: u32,
) -> FidelityReport {
    let library = task.library.clone();
    let mut envs = CpuHumanoidEnv::unstaggered(task, 0..episodes, seed);
    let mut probe = FidelityProbe::new(&library, &envs);
    let found = play_episodes(&mut envs, driver, DriverState::default(), |envs, running, _| {
        probe.observe(envs, running);
    });
    probe.report(&found)
}
