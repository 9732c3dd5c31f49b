//! The figures of the task `obstacles`.

use super::trajectories::among_obstacles;
use super::{level_marks, points};
use crate::env::locomotion::STEP_S;
use crate::report::{learning_curve, obstacle_walks};
use crate::train::checkpoint::Checkpoint;
use crate::train::locomotion::Locomotion;
use crate::train::metrics::UpdateMetrics;
use crate::train::run_dir::RunDir;
use anyhow::Result;

/// Episodes drawn.
const DRAWN: usize = 4;

/// Draws `learning_curve.png`, and `obstacle_walks.png` of the last policy.
///
/// # Errors
/// The checkpoint cannot be read, or a picture not be written.
pub fn draw(run: &RunDir, rows: &[UpdateMetrics], locomotion: &Locomotion) -> Result<()> {
    let curve = run.file("learning_curve.png");
    learning_curve::draw(&curve, &points(rows), &[], &level_marks(rows))?;
    let policy = Checkpoint::load(&run.last()?)?.policy;
    let Locomotion { task, matcher } = locomotion;
    let drawn = among_obstacles(&policy, matcher, *task, DRAWN)?;
    Ok(obstacle_walks::draw(
        &run.file("obstacle_walks.png"),
        &drawn,
        STEP_S,
    )?)
}
