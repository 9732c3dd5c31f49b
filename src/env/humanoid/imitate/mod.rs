//! The task `imitate`: move as recordings do. There is no reward but that of the style.
//!
//! [`ImitateTask`] begins episodes in recorded moments; [`evaluate`](evaluate::evaluate) compares what a
//! policy does with the recordings.

pub mod evaluate;
mod pose_track;

use super::recorded::{mean_action, start_states};
use super::task::{COMMON_STATS, EpisodeRules, GpuHumanoidTask, HumanoidTask};
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
