//! A training run: what was asked for, the loop, what it leaves behind.

pub mod ablation;
pub mod checkpoint;
pub mod config;
pub mod controller;
pub mod data;
pub mod evaluate;
pub mod folder;
pub mod milestones;
pub mod planner;
pub mod progress;
pub mod record;
pub mod recording;
pub mod trainer;
pub mod walks;
