//! The pictures of a run: its learning curve, and walks of its policies as it learned.

use super::checkpoint::Checkpoint;
use super::evaluate::{Trained, seconds, walks};
use super::folder::Folder;
use super::record::Row;
use crate::motion::database::Database;
use crate::report::learning_curve::{Mark, Point};
use crate::report::trajectories::{Group, Path};
use crate::report::{chart, learning_curve, trajectories};
use crate::world::Plane;
use anyhow::Result;
use std::sync::Arc;

/// Steps at which the paper shows its policies (figure 4): a checkpoint is kept at each.
pub const STEPS: [u64; 4] = [20_000, 100_000, 533_000, 1_000_000];
/// Episodes drawn for each policy.
const WALKS: usize = 6;

/// The milestones in `(before, now]`.
pub fn crossed(before: u64, now: u64) -> impl Iterator<Item = u64> {
    STEPS
        .into_iter()
        .filter(move |&steps| before < steps && steps <= now)
}

/// Draws `learning_curve.png` and, once a milestone is reached, `trajectories.png`.
pub fn draw(folder: &Folder, rows: &[Row], database: &Arc<Database>, task: Plane) -> Result<()> {
    let reached: Vec<u64> = STEPS
        .into_iter()
        .filter(|&steps| folder.checkpoint_at(steps).exists())
        .collect();
    let points: Vec<Point> = rows.iter().map(point).collect();
    let marks: Vec<Mark> = reached
        .iter()
        .enumerate()
        .map(|(colour, &steps)| Mark {
            steps,
            label: chart::steps(steps as f64),
            colour,
        })
        .collect();
    learning_curve::draw(&folder.file("learning_curve.png"), &points, &marks)?;
    let mut groups = Vec::new();
    for (colour, &steps) in reached.iter().enumerate() {
        let checkpoint = Checkpoint::load(&folder.checkpoint_at(steps))?;
        let walks = walks(&Trained::from(&checkpoint), database, task, WALKS)?;
        let paths = walks.into_iter().map(|walk| Path {
            label: if walk.reached {
                format!("{:.1} s", seconds(&walk))
            } else {
                String::new()
            },
            points: walk.points,
            target: walk.target,
            reached: walk.reached,
            colour,
        });
        groups.push(Group {
            title: format!("{} steps", chart::steps(checkpoint.header.steps as f64)),
            paths: paths.collect(),
        });
    }
    if !groups.is_empty() {
        trajectories::draw(&folder.file("trajectories.png"), &groups)?;
    }
    Ok(())
}

fn point(row: &Row) -> Point {
    Point {
        steps: row.steps,
        wall_s: row.wall_s,
        success: row.success,
        episode_return: row.episode_return,
        episode_length: row.episode_length,
    }
}
