//! Motion: recordings, synthetic motion, features and the database.

mod body;
pub mod bvh;
pub mod character_frame;
pub mod clip;
pub mod database;
pub mod error;
mod facing;
pub mod features;
pub mod files;
pub mod findings;
pub mod import;
mod jumps;
mod limbs;
mod listing;
pub mod manifest;
pub mod mirror;
pub mod normalise;
pub mod resample;
pub mod roles;
mod sides;
pub mod skeleton;
pub mod smooth;
pub mod synthetic;
pub mod tpose;
mod track;
pub mod units;
pub mod up;

/// Frames a second of all imported motion.
pub const RATE: f32 = 30.0;
