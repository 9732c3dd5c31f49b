//! The names that most programs begin with: `use footwork::prelude::*;`.

pub use crate::gpu::{Array, Device};
pub use crate::matching::MotionMatcher;
pub use crate::motion::database::Database;
pub use crate::motion::normalise::Weights;
pub use crate::motion::synthetic;
pub use crate::physics::mjcf;
pub use crate::physics::simulator::{Simulator, SimulatorState, SolverOptions};
pub use crate::playback::{PlacedFrame, Player};

#[cfg(feature = "train")]
pub use crate::env::locomotion::{CpuLocomotion, EnvConfig, LocomotionTask, Plane};
#[cfg(feature = "train")]
pub use crate::env::{EnvBatch, EnvSpec, Transition, VecEnv, termination};
#[cfg(feature = "train")]
pub use crate::nn::Policy;
#[cfg(feature = "train")]
pub use crate::rl::{
    Algorithm,
    ppo::{Ppo, PpoLearner},
};
