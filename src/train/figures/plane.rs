//! The figures of the task `plane`.

use super::points;
use super::trajectories::{EpisodeTrajectory, trajectories};
use crate::nn::Policy;
use crate::report::chart;
use crate::report::learning_curve::{self, Mark};
use crate::report::trajectories::{self as picture, Group, Path};
use crate::train::checkpoint::Checkpoint;
use crate::train::locomotion::Locomotion;
use crate::train::metrics::UpdateMetrics;
use crate::train::run_dir::RunDir;
use anyhow::Result;
use std::path::{Path as FilePath, PathBuf};

/// Episodes drawn for each policy.
const DRAWN: usize = 6;

/// Draws `learning_curve.png` and, once the first of `milestones` is reached, `trajectories.png`. Returns the files.
///
/// # Errors
/// A checkpoint cannot be read, or a picture not be written.
pub fn draw(
    run: &RunDir,
    rows: &[UpdateMetrics],
    milestones: &[u64],
    locomotion: &Locomotion,
) -> Result<Vec<PathBuf>> {
    let mut reached = milestones.to_vec();
    reached.retain(|&steps| run.checkpoint_at(steps).exists());
    let curve = run.file("learning_curve.png");
    learning_curve::draw(&curve, &points(rows), &marks(&reached), &[])?;
    let groups = reached.iter().enumerate().map(|(colour, &steps)| {
        let Checkpoint { header, policy, .. } = Checkpoint::load(&run.checkpoint_at(steps))?;
        group(locomotion, &policy, header.steps, colour)
    });
    let groups = groups.collect::<Result<Vec<_>>>()?;
    if groups.is_empty() {
        return Ok(vec![curve]);
    }
    let walks = run.file("trajectories.png");
    picture::draw(&walks, &groups)?;
    Ok(vec![curve, walks])
}

/// Draws the walks of a policy after so many steps.
///
/// # Errors
/// The picture cannot be written.
pub fn draw_walks(of: &Locomotion, policy: &Policy, steps: u64, path: &FilePath) -> Result<()> {
    Ok(picture::draw(path, &[group(of, policy, steps, 0)?])?)
}

/// Episodes of a policy after so many steps.
fn group(of: &Locomotion, policy: &Policy, steps: u64, colour: usize) -> Result<Group> {
    let drawn = trajectories(policy, &of.matcher, of.task, DRAWN)?;
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
        title: format!("{} steps", chart::steps(steps as f64)),
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
