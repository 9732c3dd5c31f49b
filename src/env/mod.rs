//! Thousands of environments side by side, as structure of arrays.
//!
//! [`VecEnv`] is what a learner sees of them, whatever the task and the device; [`EnvBatch`] holds those
//! of a training. [`locomotion`] are the motion-matching tasks, [`humanoid`] the simulated bodies.

pub mod batch;
pub mod body_view;
pub mod curriculum;
pub mod demonstrations;
pub mod description;
pub mod humanoid;
pub mod live_view;
pub mod locomotion;
pub mod spec;
pub mod stats;
pub mod vec_env;

pub use crate::kernels::termination;
pub use batch::EnvBatch;
pub use demonstrations::Demonstrations;
pub use spec::{EnvSpec, ObservationSpec};
pub use stats::Stats;
pub use vec_env::{Transition, VecEnv};
