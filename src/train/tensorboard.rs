//! The metrics of a run and the pictures of its policies for TensorBoard.

use super::metrics::UpdateMetrics;
use super::run_dir::RunDir;
use super::snapshots::{Snapshot, snapshots};
use crate::report::events::EventWriter;
use std::io;
use std::time::{SystemTime, UNIX_EPOCH};

/// Appends to the events of a run.
pub struct TensorBoard(EventWriter);

impl TensorBoard {
    /// Starts over with the updates that are known, and the pictures of policies until then; new ones follow.
    ///
    /// # Errors
    /// The file cannot be written, or a picture not be read.
    pub fn open(run: &RunDir, known: &[UpdateMetrics]) -> io::Result<Self> {
        let now = unix_time();
        let mut events = TensorBoard(EventWriter::create(run.path(), now)?);
        let mut pictures = match known.is_empty() {
            true => Vec::new(),
            false => snapshots(run)?,
        };
        // As if the run had gone on without the pause until now.
        let start = now - known.last().map_or(0.0, |row| row.wall_s);
        for row in known {
            let time = start + row.wall_s;
            events.show(row, time)?;
            for picture in pictures.extract_if(.., |picture| picture.steps <= row.steps) {
                events.picture(&picture, time)?;
            }
        }
        events.0.flush()?;
        Ok(events)
    }

    /// Writes an update.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&mut self, row: &UpdateMetrics) -> io::Result<()> {
        self.show(row, unix_time())?;
        self.0.flush()
    }

    /// Adds pictures of policies.
    ///
    /// # Errors
    /// One cannot be read, or the file not be written.
    pub fn add(&mut self, pictures: &[Snapshot]) -> io::Result<()> {
        let now = unix_time();
        pictures
            .iter()
            .try_for_each(|picture| self.picture(picture, now))?;
        self.0.flush()
    }

    fn picture(&mut self, picture: &Snapshot, time: f64) -> io::Result<()> {
        let file = std::fs::read(&picture.path)?;
        self.0.image(&picture.tag, picture.steps, time, &file)
    }

    fn show(&mut self, row: &UpdateMetrics, time: f64) -> io::Result<()> {
        scalars(row).try_for_each(|(tag, value)| self.0.scalar(&tag, row.steps, time, value))
    }
}

/// Tags and values of an update.
fn scalars(row: &UpdateMetrics) -> impl Iterator<Item = (String, f64)> {
    let seconds = [
        ("charts/SPS", Some(row.steps_per_s)),
        ("time/policy_s", Some(row.policy_s)),
        ("time/env_s", Some(row.env_s)),
        ("time/learn_s", Some(row.learn_s)),
        ("charts/level", row.level.map(f64::from)),
        ("charts/success", row.success),
        ("charts/episodic_return", row.episode_return),
        ("charts/episodic_length", row.episode_length),
    ];
    let fields = seconds
        .into_iter()
        .filter_map(|(tag, value)| Some((tag.to_string(), value?)));
    fields.chain(
        row.named
            .iter()
            .map(|(name, value)| (tag(name), f64::from(*value))),
    )
}

/// Where TensorBoard shows a name: the tags that CleanRL made common.
fn tag(name: &str) -> String {
    match name {
        "kl" => "losses/approx_kl".to_string(),
        "clip_fraction" => "losses/clipfrac".to_string(),
        "entropy" | "explained_variance" | "grad_norm" => format!("losses/{name}"),
        _ if name.ends_with("_loss") => format!("losses/{name}"),
        _ => match name.strip_prefix("evaluated_") {
            Some(measure) => format!("evaluation/{measure}"),
            None => format!("charts/{name}"),
        },
    }
}

fn unix_time() -> f64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0.0, |since| since.as_secs_f64())
}
