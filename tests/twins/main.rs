//! Shaders against their CPU twins, twins against the paper's formulas, searches against an f64
//! oracle, and whole worlds against each other. Every shader runs twice: by its own `launch` on
//! burn's stream, unchecked as in use, and through plain wgpu with all run-time checks on.
//! The tests need a software Vulkan adapter (lavapipe) and fail without one.

mod act;
mod checked;
mod gae;
mod inputs;
mod observe;
mod oracle;
mod paper;
mod query;
mod reset;
mod rng;
mod search;
mod search_exact;
mod search_tile;
mod search_wide;
mod step;
mod tally;
mod world;
