//! A `summary.json`, read again.

use super::config::Config;
use super::run_dir::RunDir;
use crate::input_file;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// Bytes of the longest summary.
const MAX_BYTES: u64 = 1 << 20;

/// How a training of an earlier time ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KnownSummary {
    /// Environment steps, over all resumptions.
    pub steps: u64,
    /// Seconds of training, over all resumptions.
    pub wall_s: f64,
    /// Environment steps a second.
    pub steps_per_s: f64,
    /// `steps`, `time`, `success`, `interrupt` or `failure`.
    pub stopped_by: String,
    /// Episodes of the evaluation at the end.
    pub episodes: usize,
    /// Which of the other entries is the success.
    pub success_name: String,
    /// The evaluation, and what else there is.
    #[serde(flatten)]
    others: BTreeMap<String, Value>,
}

impl KnownSummary {
    /// The summary of a run. None if it has none that this version reads.
    pub fn read(run: &RunDir) -> Option<Self> {
        let text = input_file::text(&run.summary_path(), MAX_BYTES).ok()?;
        serde_json::from_str(&text).ok()
    }

    /// Fraction of the evaluation episodes that succeeded.
    pub fn success(&self) -> f64 {
        self.measure(&self.success_name)
    }

    /// A measure of the evaluation by name; 0 if there is none.
    pub fn measure(&self, name: &str) -> f64 {
        let value = self.others.get(name).and_then(Value::as_f64);
        value.unwrap_or_default()
    }

    /// Whether the training reached one of the ends that its configuration sets.
    pub fn is_final(&self, config: &Config) -> bool {
        match self.stopped_by.as_str() {
            "steps" => self.steps >= config.steps,
            by => matches!(by, "time" | "success"),
        }
    }
}
