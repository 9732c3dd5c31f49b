//! The motion-matching tasks: reach a target, on an empty plane or among moving obstacles.
//!
//! [`task`] holds what may be chosen about them, [`config`] what else environments are opened with,
//! [`describe`] says what their numbers mean, [`kernel_params`] turns both into the kernels' parameters; [`gpu`] and [`cpu`] step environments by
//! the shaders or by their twins.

pub mod config;
pub mod cpu;
pub mod describe;
pub mod env_state;
pub mod gpu;
pub mod kernel_params;
mod open;
pub mod task;

pub use config::{EnvConfig, STAT_NAMES, STEP_S};
pub use cpu::CpuLocomotion;
pub use env_state::EnvState;
pub use task::{LEVELS, LocomotionTask, Obstacles, Plane};
