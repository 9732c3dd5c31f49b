//! Shaders against their CPU twins, twins against the paper's formulas
//! and slow geometry, searches against an f64
//! oracle, and whole worlds against each other. Every shader runs twice: by its own `launch` on
//! burn's stream, unchecked as in use, and through plain wgpu with all run-time checks on.
//! The tests need a software Vulkan adapter (lavapipe) and fail without one.

mod act;
mod batch;
mod bodies;
mod ceiling;
mod checked;
mod collide;
mod contact;
mod gae;
mod geometry;
mod ground;
mod hits;
mod inputs;
mod keep;
mod learning;
mod observe;
mod obstacles;
mod oracle;
mod paper;
mod query;
mod reset;
mod reward;
mod rng;
mod scatter;
mod search;
mod sense;
mod step;
mod tally;
mod wander;
mod world;
