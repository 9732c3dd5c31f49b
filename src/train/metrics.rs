//! The metrics of an update: a line of `metrics.jsonl`.

use super::evaluation::Evaluation;
use crate::input_file;
use crate::rl::Iteration;
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// An update.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UpdateMetrics {
    /// Number of the update, from 1.
    pub update: u64,
    /// Environment steps so far.
    pub steps: u64,
    /// Seconds of training so far, over all resumptions.
    pub wall_s: f64,
    /// Level of the curriculum in this update.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub level: Option<u32>,
    /// Levels passed before this update.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub levels_passed: Option<u32>,
    /// Episodes that ended in this update.
    pub episodes: f64,
    /// Means over those episodes; none if none ended.
    pub success: Option<f64>,
    /// Sum of rewards.
    pub episode_return: Option<f64>,
    /// Steps.
    pub episode_length: Option<f64>,
    /// Environment steps a second in this update.
    pub steps_per_s: f64,
    /// Seconds in the networks while acting.
    pub policy_s: f64,
    /// Seconds in the environments.
    pub env_s: f64,
    /// Seconds of learning.
    pub learn_s: f64,
    /// Seconds of these in which the first rank talked to the others, and waited for them.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub communication_s: Option<f64>,
    /// Whatever else has a name: losses; means of the environments' own statistics over the episodes
    /// that ended; and, when the evaluation episodes were run, what they found, as `evaluated_...`.
    #[serde(flatten)]
    pub named: BTreeMap<String, f32>,
}

/// Statistics of every environment, which have fields of their own.
const COMMON: [&str; 4] = ["episodes", "successes", "steps", "returns"];

impl UpdateMetrics {
    /// The losses, statistics and seconds of an update.
    pub fn new(iteration: &Iteration) -> Self {
        let stats = &iteration.stats;
        let own = stats.iter().map(|(name, _)| name);
        let own = own.filter(|name| !COMMON.contains(name));
        let rates = own.filter_map(|name| Some((name, stats.mean(name)?)));
        let named = iteration.losses.iter().copied().chain(rates);
        UpdateMetrics {
            episodes: stats.sum("episodes"),
            success: stats.mean("successes"),
            episode_return: stats.mean("returns"),
            episode_length: stats.mean("steps"),
            policy_s: iteration.policy_s,
            env_s: iteration.env_s,
            learn_s: iteration.learn_s,
            named: named
                .map(|(name, value)| (name.to_string(), value as f32))
                .collect(),
            ..UpdateMetrics::default()
        }
    }

    /// Takes the result of an evaluation in.
    pub fn evaluated(&mut self, found: &Evaluation) {
        let success = [("success", found.success)];
        let measures = found.measures.iter().map(|(name, value)| (*name, *value));
        for (name, value) in success.into_iter().chain(measures) {
            self.named.insert(format!("evaluated_{name}"), value as f32);
        }
    }

    /// The mean of one of the environments' own statistics, by name.
    pub fn rate(&self, name: &str) -> Option<f64> {
        self.named.get(name).copied().map(f64::from)
    }
}

/// What a `metrics.jsonl` holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KnownMetrics {
    /// The updates up to a number of steps, in order.
    pub rows: Vec<UpdateMetrics>,
    /// Numbers of the lines that are none, from 1.
    pub damaged: Vec<usize>,
}

/// Bytes of the longest metrics: millions of updates.
const MAX_BYTES: u64 = 1 << 34;

/// Reads a `metrics.jsonl` up to a number of steps. A line that is no update costs that line.
///
/// # Errors
/// It cannot be read.
pub fn read(path: &Path, up_to: u64) -> Result<KnownMetrics> {
    let mut known = KnownMetrics::default();
    if !path.exists() {
        return Ok(known);
    }
    let bytes = input_file::bytes(path, MAX_BYTES).with_context(|| {
        format!(
            "cannot read {}; move it away to go on without it",
            path.display()
        )
    })?;
    let text = String::from_utf8_lossy(&bytes);
    for (number, line) in text.lines().enumerate() {
        match serde_json::from_str::<UpdateMetrics>(line) {
            Ok(row) if row.steps <= up_to => known.rows.push(row),
            Ok(_) => {}
            // Nothing is lost with it.
            Err(_) if line.trim().is_empty() => {}
            Err(_) => known.damaged.push(number + 1),
        }
    }
    Ok(known)
}
