//! Motion: recordings, synthetic motion, features and the database.

pub mod bvh;
pub mod character_frame;
pub mod clip;
pub mod database;
pub mod error;
pub mod features;
pub mod import;
pub mod manifest;
pub mod mirror;
pub mod normalise;
pub mod resample;
pub mod roles;
pub mod skeleton;
pub mod smooth;
pub mod synthetic;
pub mod tpose;
pub mod units;

/// Frames a second of all imported motion.
pub const RATE: f32 = 30.0;
