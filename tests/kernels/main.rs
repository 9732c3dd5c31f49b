//! Shaders against their CPU twins, twins against the paper's formulas and slow geometry, searches against
//! an f64 oracle. Every shader runs twice: by its own `launch` on burn's stream, unchecked as in use, and
//! through plain wgpu with all run-time checks on.
//! The tests need a software Vulkan adapter (lavapipe) and fail without one.

#[macro_use]
#[path = "../support/mod.rs"]
mod support;

mod bench;
mod humanoid;
mod learn;
mod locomotion;
mod physics;
mod rng;
mod search;
mod self_play;

use support::{checked, inputs, oracle};
