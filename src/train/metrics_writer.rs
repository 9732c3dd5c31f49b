//! Writes the metrics of a run: `metrics.jsonl`, and TensorBoard's events.

use super::metrics::UpdateMetrics;
#[cfg(feature = "report")]
use super::tensorboard::TensorBoard;
use crate::container::write_whole;
use anyhow::{Context, Result};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Appends to a run's metrics and events.
pub struct MetricsWriter {
    lines: File,
    path: PathBuf,
    #[cfg(feature = "report")]
    events: TensorBoard,
}

impl MetricsWriter {
    /// Starts over with the rows that are known; new ones follow.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn open(folder: &Path, known: &[UpdateMetrics]) -> Result<Self> {
        let path = folder.join("metrics.jsonl");
        let mut text = String::new();
        for row in known {
            text += &serde_json::to_string(row)?;
            text.push('\n');
        }
        write_whole(&path, text.as_bytes())?;
        let lines = File::options().append(true).open(&path);
        let lines = lines.with_context(|| format!("cannot write {}", path.display()))?;
        Ok(MetricsWriter {
            lines,
            path,
            #[cfg(feature = "report")]
            events: TensorBoard::open(folder, known)?,
        })
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
        self.events.write(row)?;
        Ok(())
    }
}
