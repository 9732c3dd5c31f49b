//! What every update writes down: a line of `metrics.jsonl` and TensorBoard's scalars.

use crate::report::events::EventWriter;
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// One update.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    pub update: u64,
    /// Environment steps so far.
    pub steps: u64,
    /// Seconds of training so far, over all resumptions.
    pub wall_s: f64,
    /// Of the curriculum, in this update.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub level: Option<u32>,
    /// Of the ten, before this update.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub levels_passed: Option<u32>,
    /// Episodes that ended in this update.
    pub episodes: f64,
    /// Means over those episodes; nothing if none ended.
    pub success: Option<f64>,
    /// Ran into an obstacle.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub collision: Option<f64>,
    /// Ran out of steps.
    #[serde(default)]
    pub truncation: Option<f64>,
    pub episode_return: Option<f64>,
    /// Steps.
    pub episode_length: Option<f64>,
    pub policy_loss: f32,
    pub value_loss: f32,
    pub entropy: f32,
    pub kl: f32,
    pub clip_fraction: f32,
    pub explained_variance: f32,
    pub learning_rate: f64,
    /// Of this update, and the seconds its parts took.
    pub steps_per_s: f64,
    pub simulate_s: f64,
    pub act_s: f64,
    pub learn_s: f64,
    /// Success and mean time to target (s) over the evaluation episodes, when they were run.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub evaluated_success: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub evaluated_time_s: Option<f64>,
}

impl Row {
    /// Names and values of what TensorBoard shows, under the names everyone knows.
    fn scalars(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let always = [
            ("losses/policy_loss", self.policy_loss.into()),
            ("losses/value_loss", self.value_loss.into()),
            ("losses/entropy", self.entropy.into()),
            ("losses/approx_kl", self.kl.into()),
            ("losses/clipfrac", self.clip_fraction.into()),
            ("losses/explained_variance", self.explained_variance.into()),
            ("charts/learning_rate", self.learning_rate),
            ("charts/SPS", self.steps_per_s),
            ("time/simulate_s", self.simulate_s),
            ("time/act_s", self.act_s),
            ("time/learn_s", self.learn_s),
        ];
        let sometimes = [
            ("charts/level", self.level.map(f64::from)),
            ("charts/success", self.success),
            ("charts/collision", self.collision),
            ("charts/truncation", self.truncation),
            ("charts/episodic_return", self.episode_return),
            ("charts/episodic_length", self.episode_length),
            ("evaluation/success", self.evaluated_success),
            ("evaluation/time_to_target_s", self.evaluated_time_s),
        ];
        always.into_iter().chain(
            sometimes
                .into_iter()
                .filter_map(|(name, value)| Some((name, value?))),
        )
    }
}

/// Appends to a run's metrics and events.
pub struct Recorder {
    lines: File,
    path: PathBuf,
    events: EventWriter,
}

/// The rows of a `metrics.jsonl` up to a number of steps. Lines that a crash cut short end the
/// reading.
pub fn read(path: &Path, up_to: u64) -> Result<Vec<Row>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text = std::fs::read_to_string(path).with_context(|| {
        format!(
            "cannot read {}; move it away to go on without it",
            path.display()
        )
    })?;
    let rows = text
        .lines()
        .map_while(|line| serde_json::from_str::<Row>(line).ok());
    Ok(rows.take_while(|row| row.steps <= up_to).collect())
}

impl Recorder {
    /// Starts over with the rows that are known; new ones follow.
    pub fn open(folder: &Path, known: &[Row]) -> Result<Self> {
        let path = folder.join("metrics.jsonl");
        let mut text = String::new();
        for row in known {
            text += &serde_json::to_string(row)?;
            text.push('\n');
        }
        crate::container::write_whole(&path, text.as_bytes())?;
        let lines = File::options().append(true).open(&path);
        let lines = lines.with_context(|| format!("cannot write {}", path.display()))?;
        let now = unix_time();
        let mut recorder = Recorder {
            lines,
            path,
            events: EventWriter::create(folder, now)?,
        };
        // As if the run had gone on without the pause until now.
        let start = now - known.last().map_or(0.0, |row| row.wall_s);
        for row in known {
            recorder.show(row, start + row.wall_s)?;
        }
        recorder.events.flush()?;
        Ok(recorder)
    }

    fn show(&mut self, row: &Row, time: f64) -> Result<()> {
        for (tag, value) in row.scalars() {
            self.events.scalar(tag, row.steps, time, value)?;
        }
        Ok(())
    }

    pub fn write(&mut self, row: &Row) -> Result<()> {
        let mut line = serde_json::to_string(row)?;
        line.push('\n');
        self.lines
            .write_all(line.as_bytes())
            .with_context(|| format!("cannot write {}", self.path.display()))?;
        self.show(row, unix_time())?;
        self.events.flush()?;
        Ok(())
    }
}

fn unix_time() -> f64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0.0, |since| since.as_secs_f64())
}
