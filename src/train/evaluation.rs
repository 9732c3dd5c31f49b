//! What may be asked of an evaluation, and what it found, whatever the task.

use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// What the fixed episodes of an evaluation found.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// Episodes to play, or played.
    pub episodes: usize,
    /// Fraction of the episodes that succeeded.
    pub success: f64,
    /// What a success is called in files.
    pub success_name: &'static str,
    /// Whatever else the task measures, by name.
    pub measures: BTreeMap<&'static str, f64>,
}

impl Default for Evaluation {
    fn default() -> Self {
        Evaluation {
            episodes: 0,
            success: 0.0,
            success_name: "success",
            measures: BTreeMap::new(),
        }
    }
}

impl Serialize for Evaluation {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let episodes = [("episodes", serde_json::json!(self.episodes))];
        let name = [("success_name", self.success_name.into())];
        let success = [(self.success_name, self.success.into())];
        let measures = self.measures.iter();
        let measures = measures.map(|(name, value)| (*name, (*value).into()));
        let first = episodes.into_iter().chain(name).chain(success);
        to.collect_map(first.chain(measures))
    }
}

impl Evaluation {
    /// A measure by name; 0 if there is none.
    pub fn measure(&self, name: &str) -> f64 {
        self.measures.get(name).copied().unwrap_or_default()
    }
}

/// What `footwork eval` may be asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EvalOptions {
    /// Episodes to play, or played.
    pub episodes: usize,
    /// A scripted controller beside the policy.
    pub baseline: bool,
    /// Episodes to plan with full knowledge.
    pub planner: usize,
    /// The quality of the whole body's motion.
    pub motion_quality: bool,
}

/// A report for people and one for programs.
pub struct EvalReport {
    /// For people.
    pub text: String,
    /// For programs.
    pub json: serde_json::Value,
}
