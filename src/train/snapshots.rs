//! Pictures of what policies do in their fixed episodes, made where checkpoints are kept: `pictures/walks`, the
//! ways seen from above, and `pictures/film`, for which somebody must be there who can film.

use super::figures::walks::draw_walks;
use super::observer::Observer;
use super::run_dir::{RunDir, name_at};
use super::task::Task;
use crate::container::write_whole;
use crate::nn::Policy;
use anyhow::{Context, Result};
use std::io;
use std::path::PathBuf;
use std::time::Instant;

/// What a film takes at most, as long as none has been made, s.
const FIRST_FILM_S: f64 = 1.0;

/// A picture of what a policy does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Snapshot {
    /// Where TensorBoard shows it.
    pub tag: String,
    /// Environment steps after which it was made.
    pub steps: u64,
    /// A PNG or GIF file.
    pub path: PathBuf,
}

/// All pictures of a run's policies, in the order of their steps.
///
/// # Errors
/// A folder cannot be read.
pub fn snapshots(run: &RunDir) -> io::Result<Vec<Snapshot>> {
    let mut found = Vec::new();
    for kind in [WALKS, FILM] {
        let folder = run.pictures().join(kind);
        if !folder.exists() {
            continue;
        }
        for entry in std::fs::read_dir(folder)? {
            let path = entry?.path();
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let steps = name.strip_prefix("steps-").and_then(|n| n.parse().ok());
            if let Some(steps) = steps {
                let tag = tag(kind);
                found.push(Snapshot { tag, steps, path });
            }
        }
    }
    found.sort_by(|a, b| (a.steps, &a.tag).cmp(&(b.steps, &b.tag)));
    Ok(found)
}

const WALKS: &str = "walks";
const FILM: &str = "film";

impl Snapshot {
    /// A picture that is to be made: its folder is.
    fn new(run: &RunDir, kind: &str, steps: u64, ending: &str) -> Result<Snapshot> {
        let folder = run.pictures().join(kind);
        std::fs::create_dir_all(&folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        Ok(Snapshot {
            tag: tag(kind),
            steps,
            path: folder.join(format!("{}.{ending}", name_at(steps))),
        })
    }
}

fn tag(kind: &str) -> String {
    format!("episodes/{kind}")
}

/// What makes them during a training.
pub struct SnapshotMaker<'a> {
    run: &'a RunDir,
    task: &'a dyn Task,
    /// Fraction of the training's time that films may take.
    share: f64,
    start: Instant,
    /// Seconds that films have taken, and the longest of them.
    spent_s: f64,
    longest_s: Option<f64>,
}

impl<'a> SnapshotMaker<'a> {
    /// For a training that begins. `share` is the fraction of its time that films may take.
    pub fn new(run: &'a RunDir, task: &'a dyn Task, share: f64) -> Self {
        SnapshotMaker {
            run,
            task,
            share,
            start: Instant::now(),
            spent_s: 0.0,
            longest_s: None,
        }
    }

    /// Pictures of a policy after so many steps.
    ///
    /// # Errors
    /// One cannot be made or written.
    pub fn take(
        &mut self,
        policy: &Policy,
        steps: u64,
        observer: &mut dyn Observer,
    ) -> Result<Vec<Snapshot>> {
        let mut made = Vec::new();
        if let Some(locomotion) = self.task.locomotion() {
            let walks = Snapshot::new(self.run, WALKS, steps, "png")?;
            draw_walks(locomotion, policy, steps, &walks.path)?;
            made.push(walks);
        }
        if let Some(gif) = self.film(policy, observer)? {
            let film = Snapshot::new(self.run, FILM, steps, "gif")?;
            write_whole(&film.path, &gif)?;
            made.push(film);
        }
        Ok(made)
    }

    /// A film of a policy, if somebody can make one, and another one keeps within what films may take.
    fn film(&mut self, policy: &Policy, observer: &mut dyn Observer) -> Result<Option<Vec<u8>>> {
        let next_s = self.longest_s.unwrap_or(FIRST_FILM_S);
        if self.spent_s + next_s > self.share * self.start.elapsed().as_secs_f64() {
            return Ok(None);
        }
        let begin = Instant::now();
        let film = observer.film(policy)?;
        let took_s = begin.elapsed().as_secs_f64();
        self.spent_s += took_s;
        self.longest_s = Some(took_s.max(self.longest_s.unwrap_or_default()));
        Ok(film)
    }
}
