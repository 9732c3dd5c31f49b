//! What an evaluation found, whatever the task.

use serde::Serialize;
use std::collections::BTreeMap;

/// What the fixed episodes of an evaluation found.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Evaluation {
    pub episodes: usize,
    /// Fraction of the episodes that succeeded.
    pub success: f64,
    /// Whatever else the task measures, by name.
    #[serde(flatten)]
    pub measures: BTreeMap<&'static str, f64>,
}

impl Evaluation {
    /// A measure by name; 0 if there is none.
    pub fn measure(&self, name: &str) -> f64 {
        self.measures.get(name).copied().unwrap_or_default()
    }
}
