//! Writes the metrics of a run: `metrics.jsonl`, and TensorBoard's events.

use super::metrics::UpdateMetrics;
use super::run_dir::RunDir;
#[cfg(feature = "report")]
use super::{snapshots::Snapshot, tensorboard::TensorBoard};
use crate::container::write_whole;
use anyhow::{Context, Result};
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;

/// Appends to a run's metrics and events.
pub struct MetricsWriter {
    lines: File,
    path: PathBuf,
    /// Until they cannot be written.
    #[cfg(feature = "report")]
    events: Option<TensorBoard>,
    /// What the user should know.
    note: Option<String>,
}

impl MetricsWriter {
    /// Starts over with the rows that are known; new ones follow.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn open(run: &RunDir, known: &[UpdateMetrics]) -> Result<Self> {
        let path = run.metrics_path();
        let mut text = String::new();
        for row in known {
            text += &serde_json::to_string(row)?;
            text.push('\n');
        }
        write_whole(&path, text.as_bytes())?;
        let lines = File::options().append(true).open(&path);
        let lines = lines.with_context(|| format!("cannot write {}", path.display()))?;
        #[cfg(feature = "report")]
        let events = TensorBoard::open(run, known);
        Ok(MetricsWriter {
            lines,
            path,
            #[cfg(feature = "report")]
            note: events.as_ref().err().map(unwritten),
            #[cfg(not(feature = "report"))]
            note: None,
            #[cfg(feature = "report")]
            events: events.ok(),
        })
    }

    /// What the user should know and has not been told.
    pub fn take_note(&mut self) -> Option<String> {
        self.note.take()
    }

    /// Writes an update.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&mut self, row: &UpdateMetrics) -> Result<()> {
        let mut line = serde_json::to_string(row)?;
        line.push('\n');
        self.lines
            .write_all(line.as_bytes())
            .with_context(|| format!("cannot write {}", self.path.display()))?;
        #[cfg(feature = "report")]
        self.event(|events| events.write(row));
        Ok(())
    }

    /// Adds pictures to the events.
    #[cfg(feature = "report")]
    pub fn add(&mut self, pictures: &[Snapshot]) {
        self.event(|events| events.add(pictures));
    }

    /// Writes something for TensorBoard, as long as that can be done.
    #[cfg(feature = "report")]
    fn event(&mut self, write: impl FnOnce(&mut TensorBoard) -> std::io::Result<()>) {
        if let Some(Err(error)) = self.events.as_mut().map(write) {
            self.note = Some(unwritten(&error));
            self.events = None;
        }
    }
}

/// TensorBoard's curves are not worth a training.
#[cfg(feature = "report")]
fn unwritten(error: &std::io::Error) -> String {
    format!("note: {error}; the training goes on without events for TensorBoard")
}
