//! A training run: what was asked for, the loop, what it leaves behind.

pub mod ablation;
pub mod checkpoint;
pub mod config;
pub mod controller;
pub mod data;
pub mod evaluate;
pub mod run_dir;
pub mod figures;
pub mod planner;
pub mod progress;
pub mod metrics;
pub mod rendered_frames;
pub mod trainer;
pub mod trajectories;
