//! One file per shader: its parameters, its launch and its CPU twin, all with one name and one
//! order of arguments. The twin is the shader's oracle and the CPU backend's kernel.
//!
//! - [`locomotion`]: a step of the motion-matching environments;
//! - [`search`]: the nearest database frame;
//! - [`physics`]: a step of the articulated bodies;
//! - [`humanoid`]: what tasks of the simulated humanoid add to it;
//! - [`learn`]: sampling, advantages, and the gradient step of dense networks;
//! - [`self_play`]: bouts against policies that learn no more;
//! - [`mod@bench`]: what a device could do at most;
//! - [`fma`]: multiplication and addition in one;
//! - [`rng`]: counter-based random numbers that shaders and twins share;
//! - [`termination`]: how a step ends.

pub mod bench;
pub mod fma;
pub mod humanoid;
pub mod learn;
pub mod locomotion;
pub mod physics;
pub mod rng;
pub mod search;
pub mod self_play;
pub mod termination;
