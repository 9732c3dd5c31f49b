//! The figures of the task `plane`.

use super::points;
use super::trajectories::{EpisodeTrajectory, trajectories};
use crate::report::chart;
use crate::report::learning_curve::{self, Mark};
use crate::report::trajectories::{self as picture, Group, Path};
use crate::train::checkpoint::Checkpoint;
use crate::train::locomotion::Locomotion;
use crate::train::metrics::UpdateMetrics;
use crate::train::run_dir::RunDir;
use anyhow::Result;

/// Episodes drawn for each policy.
const DRAWN: usize = 6;

/// Draws `learning_curve.png` and, once the first of `milestones` is reached, `trajectories.png`.
///
/// # Errors
/// A checkpoint cannot be read, or a picture not be written.
pub fn draw(
    run: &RunDir,
    rows: &[UpdateMetrics],
    milestones: &[u64],
    locomotion: &Locomotion,
) -> Result<()> {
    let mut reached = milestones.to_vec();
    reached.retain(|&steps| run.checkpoint_at(steps).exists());
    let curve = run.file("learning_curve.png");
    learning_curve::draw(&curve, &points(rows), &marks(&reached), &[])?;
    let groups = reached.iter().enumerate();
    let groups = groups.map(|(colour, &steps)| group(run, locomotion, steps, colour));
    let groups = groups.collect::<Result<Vec<_>>>()?;
    match groups.is_empty() {
        true => Ok(()),
        false => Ok(picture::draw(&run.file("trajectories.png"), &groups)?),
    }
}

/// Episodes of the policy at a milestone.
fn group(run: &RunDir, locomotion: &Locomotion, steps: u64, colour: usize) -> Result<Group> {
    let checkpoint = Checkpoint::load(&run.checkpoint_at(steps))?;
    let Locomotion { task, matcher } = locomotion;
    let drawn = trajectories(&checkpoint.policy, matcher, *task, DRAWN)?;
    let path = |one: EpisodeTrajectory| Path {
        label: match one.reached {
            true => format!("{:.1} s", one.seconds()),
            false => String::new(),
        },
        points: one.points,
        target: one.target,
        reached: one.reached,
        colour,
    };
    Ok(Group {
        title: format!("{} steps", chart::steps(checkpoint.header.steps as f64)),
        paths: drawn.into_iter().map(path).collect(),
    })
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
