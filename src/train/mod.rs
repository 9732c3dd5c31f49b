//! Training: configuration, the loop, checkpoints, evaluation and figures.
//!
//! [`trainer`] and [`checkpoint`] know no task. A [`task`] is one value that opens environments,
//! evaluates policies and draws figures; [`tasks`] is the list of them.

pub mod agreement;
pub mod anchors;
pub mod body_episodes;
pub mod body_policy;
pub mod calibration;
pub mod checkpoint;
pub mod comparison;
pub mod config;
pub mod controller;
pub mod data;
pub mod elo;
pub mod eval_report;
pub mod evaluate;
pub mod evaluation;
#[cfg(feature = "report")]
pub mod figures;
pub mod fingerprint;
pub mod known_summary;
pub mod locomotion;
pub mod low_level;
pub mod memory;
pub mod metrics;
pub mod metrics_writer;
pub mod observer;
pub mod planner;
pub mod playthrough;
pub mod rendered_frames;
pub mod run_dir;
#[cfg(feature = "report")]
pub mod snapshots;
pub mod state;
pub mod task;
pub mod tasks;
#[cfg(feature = "report")]
pub mod tensorboard;
pub mod tournament;
pub mod trainer;
