//! The pictures of a run: its learning curve, and walks of its policies as it learned.

use super::checkpoint::Checkpoint;
use super::controller::Trained;
use super::evaluate::SECONDS_A_STEP;
use super::run_dir::Folder;
use super::metrics::Row;
use super::trajectories::{among_obstacles, walks};
use crate::motion::database::Database;
use crate::report::learning_curve::{Level, Mark, Point};
use crate::report::trajectories::{Group, Path};
use crate::report::{chart, learning_curve, obstacle_walks, trajectories};
use crate::env::locomotion::Task;
use anyhow::Result;
use std::sync::Arc;

/// Steps at which the paper shows its policies (figure 4): a checkpoint is kept at each.
pub const STEPS: [u64; 4] = [20_000, 100_000, 533_000, 1_000_000];
/// Episodes drawn for each policy.
const WALKS: usize = 6;
/// Episodes drawn among obstacles.
const OBSTACLE_WALKS: usize = 4;

/// The milestones in `(before, now]`.
pub fn crossed(before: u64, now: u64) -> impl Iterator<Item = u64> {
    STEPS
        .into_iter()
        .filter(move |&steps| before < steps && steps <= now)
}

/// Draws `learning_curve.png`, and walks: on the plane, once a milestone is reached,
/// `trajectories.png`; among obstacles `obstacle_walks.png` of the last policy.
pub fn draw(folder: &Folder, rows: &[Row], database: &Arc<Database>, task: Task) -> Result<()> {
    let curve = folder.file("learning_curve.png");
    let points: Vec<Point> = rows.iter().map(point).collect();
    match task {
        Task::Plane(_) => {
            let reached: Vec<u64> = STEPS
                .into_iter()
                .filter(|&steps| folder.checkpoint_at(steps).exists())
                .collect();
            learning_curve::draw(&curve, &points, &marks(&reached), &[])?;
            draw_walks(folder, &reached, database, task)
        }
        Task::Obstacles(_) => {
            learning_curve::draw(&curve, &points, &[], &levels(rows))?;
            let policy = Trained::from(&Checkpoint::load(&folder.last()?)?);
            let walks = among_obstacles(&policy, database, task, OBSTACLE_WALKS)?;
            let picture = folder.file("obstacle_walks.png");
            Ok(obstacle_walks::draw(&picture, &walks, SECONDS_A_STEP)?)
        }
    }
}

fn marks(reached: &[u64]) -> Vec<Mark> {
    let marks = reached.iter().enumerate();
    marks
        .map(|(colour, &steps)| Mark {
            steps,
            label: chart::steps(steps as f64),
            colour,
        })
        .collect()
}

/// Where each level but the first begins.
fn levels(rows: &[Row]) -> Vec<Level> {
    let rises = rows
        .windows(2)
        .filter(|pair| pair[0].level != pair[1].level);
    rises
        .filter_map(|pair| {
            Some(Level {
                steps: pair[0].steps,
                level: pair[1].level? as usize,
            })
        })
        .collect()
}

fn draw_walks(
    folder: &Folder,
    reached: &[u64],
    database: &Arc<Database>,
    task: Task,
) -> Result<()> {
    let mut groups = Vec::new();
    for (colour, &steps) in reached.iter().enumerate() {
        let checkpoint = Checkpoint::load(&folder.checkpoint_at(steps))?;
        let walks = walks(&Trained::from(&checkpoint), database, task, WALKS)?;
        let paths = walks.into_iter().map(|walk| Path {
            label: if walk.reached {
                format!("{:.1} s", walk.seconds())
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

/// A row of the metrics as a curve shows it.
pub fn point(row: &Row) -> Point {
    Point {
        steps: row.steps,
        wall_s: row.wall_s,
        success: row.success,
        episode_return: row.episode_return,
        episode_length: row.episode_length,
    }
}
