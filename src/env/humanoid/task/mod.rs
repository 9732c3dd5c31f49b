//! What differs between the tasks of simulated bodies, and the environments that play any of them.
//!
//! [`HumanoidTask`] is what a task adds to a step of the physics; [`open`] opens a batch of it on either
//! device; [`EpisodeRules`] says how long an episode is and when it has failed.

mod common;
mod cpu;
pub mod describe;
mod gpu;
mod humanoid_task;
mod open;
pub mod play;
mod rules;

pub use common::{KEY_BODIES, agent_bodies, agent_body, agents, characters, spec};
pub use cpu::CpuHumanoidEnv;
pub use humanoid_task::{
    COMMON_STATS, GpuHumanoidTask, HumanoidTask, StepContext, StepOutcome, TaskBuffers,
};
pub use open::open;
pub use rules::{DT, EpisodeRules, check_range};
