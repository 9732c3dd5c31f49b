//! Whole environments: their devices against each other, their parts against all together, their episodes
//! against the seams' words.
//! The tests need a software Vulkan adapter (lavapipe) and fail without one.

#[path = "../support/mod.rs"]
mod support;

mod humanoid;
mod locomotion;
mod pendulum;
