//! The figures of a run, a file a task, and what they share: points of the learning curve, and marks on
//! it.

pub mod obstacles;
pub mod plane;
pub mod trajectories;
pub mod walks;

use super::metrics::UpdateMetrics;
use super::run_dir::RunDir;
use crate::report::learning_curve::{self, Level, Point};
use anyhow::Result;
use std::path::PathBuf;

/// The metrics as a curve shows them.
pub fn points(rows: &[UpdateMetrics]) -> Vec<Point> {
    let points = rows.iter().map(|row| Point {
        steps: row.steps,
        wall_s: row.wall_s,
        success: row.success,
        episode_return: row.episode_return,
        episode_length: row.episode_length,
        fall: row.rate("fall"),
        style_reward: row.rate("style_reward"),
        task_weight: row.rate("task_weight"),
        recorded_accuracy: row.rate("recorded_accuracy"),
        agent_accuracy: row.rate("agent_accuracy"),
    });
    points.collect()
}

/// Where each level but the first begins.
pub fn level_marks(rows: &[UpdateMetrics]) -> Vec<Level> {
    let rises = rows
        .windows(2)
        .filter(|pair| pair[0].level != pair[1].level);
    let marks = rises.filter_map(|pair| {
        Some(Level {
            steps: pair[0].steps,
            level: pair[1].level? as usize,
        })
    });
    marks.collect()
}

/// Draws `learning_curve.png` without marks. Returns the file.
///
/// # Errors
/// It cannot be written.
pub fn draw_curve(run: &RunDir, rows: &[UpdateMetrics]) -> Result<Vec<PathBuf>> {
    let curve = run.file("learning_curve.png");
    learning_curve::draw(&curve, &points(rows), &[], &[])?;
    Ok(vec![curve])
}
