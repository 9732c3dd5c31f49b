//! The figures of the task `obstacles`.

use super::trajectories::among_obstacles;
use super::{level_marks, points};
use crate::env::locomotion::STEP_S;
use crate::nn::Policy;
use crate::report::{learning_curve, obstacle_walks};
use crate::train::checkpoint::Checkpoint;
use crate::train::locomotion::Locomotion;
use crate::train::metrics::UpdateMetrics;
use crate::train::run_dir::RunDir;
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Episodes drawn.
const DRAWN: usize = 4;

/// Draws `learning_curve.png`, and `obstacle_walks.png` of the last policy. Returns the files.
///
/// # Errors
/// The checkpoint cannot be read, or a picture not be written.
pub fn draw(run: &RunDir, rows: &[UpdateMetrics], locomotion: &Locomotion) -> Result<Vec<PathBuf>> {
    let files = ["learning_curve.png", "obstacle_walks.png"].map(|name| run.file(name));
    learning_curve::draw(&files[0], &points(rows), &[], &level_marks(rows))?;
    let policy = Checkpoint::load(&run.last()?)?.policy;
    draw_walks(locomotion, &policy, &files[1])?;
    Ok(files.into())
}

/// Draws the walks of a policy.
///
/// # Errors
/// The picture cannot be written.
pub fn draw_walks(of: &Locomotion, policy: &Policy, path: &Path) -> Result<()> {
    let drawn = among_obstacles(policy, &of.matcher, of.task, DRAWN)?;
    Ok(obstacle_walks::draw(path, &drawn, STEP_S)?)
}
