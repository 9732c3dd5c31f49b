//! What is said of an exported policy: all that a program must know to run it.
//!
//! It is written as one JSON document under the key [`METADATA_KEY`], beside some plain keys.

use super::network::NetworkDescription;
use crate::env::description::VectorPart;
use crate::train::checkpoint::Header;
use crate::train::config::VERSION;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// The key of the document in a file's metadata.
pub const METADATA_KEY: &str = "footwork";
/// Version of the document's layout: whatever changes the meaning of a key changes it.
const LAYOUT: u32 = 1;

/// All that a program must know to run a policy.
#[derive(Clone, Debug, Serialize)]
pub struct PolicyDescription {
    /// Version of this document's layout.
    pub layout: u32,
    /// The program that wrote it.
    pub footwork_version: String,
    /// The task that the policy has learned.
    pub task: String,
    /// What it is to do, in a sentence.
    pub about: String,
    /// Environment steps that it was trained for.
    pub trained_steps: u64,
    /// Checksum of the database or the recordings that it was trained with; it is of no use with other ones.
    pub data_fingerprint: String,
    /// Checksum of the low level that it steers, whose network is in the file, too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub low_level_fingerprint: Option<String>,
    /// Length of a step, s: how long an output holds.
    pub step_s: f32,
    /// Units and axes.
    pub conventions: Vec<&'static str>,
    /// The frames of reference that are named below.
    pub frames: BTreeMap<&'static str, &'static str>,
    /// In the order of the file.
    pub inputs: Vec<PortDescription>,
    /// In the order of the file.
    pub outputs: Vec<PortDescription>,
    /// How to run it, step by step.
    pub procedure: Vec<String>,
    /// What its task or its kind needs besides, by name.
    #[serde(flatten)]
    pub more: BTreeMap<&'static str, Value>,
    /// The task's own choices, as in the run's configuration.
    pub settings: Value,
    /// What the networks are made of, for those who evaluate them from the parameters alone.
    pub networks: Vec<NetworkDescription>,
}

/// An input or an output, of a batch of rows.
#[derive(Clone, Debug, Serialize)]
pub struct PortDescription {
    /// As in the file.
    pub name: &'static str,
    /// Its shape behind the batch.
    pub shape: Vec<usize>,
    /// The type of every number.
    pub dtype: &'static str,
    /// What it is.
    pub meaning: String,
    /// What its numbers are, if it is a vector.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PlacedPart>,
    /// What its cells are, if it is maps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub maps: Option<Value>,
}

/// A part of a vector, and where it is.
#[derive(Clone, Debug, Serialize)]
pub struct PlacedPart {
    /// Index of its first number.
    pub first: usize,
    /// What its numbers are.
    #[serde(flatten)]
    pub part: VectorPart,
}

impl PolicyDescription {
    /// What is known of every run; the kind of its policy says the rest.
    pub fn new(header: &Header, about: &str, settings: Value) -> Self {
        let low_level = header.fingerprint.low_level;
        PolicyDescription {
            layout: LAYOUT,
            footwork_version: VERSION.to_string(),
            task: header.task.clone(),
            about: about.to_string(),
            trained_steps: header.steps,
            data_fingerprint: format!("{:08x}", header.fingerprint.data),
            low_level_fingerprint: (low_level != 0).then(|| format!("{low_level:08x}")),
            step_s: header.spec.dt,
            conventions: Vec::new(),
            frames: BTreeMap::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            procedure: Vec::new(),
            more: BTreeMap::new(),
            settings: shortest(settings),
            networks: Vec::new(),
        }
    }

    /// Says what the kind of policy needs besides.
    pub fn add(&mut self, name: &'static str, value: Value) {
        self.more.insert(name, shortest(value));
    }

    /// Keys and values of a file's metadata.
    ///
    /// # Errors
    /// None: everything has a form in JSON.
    pub fn metadata(&self) -> serde_json::Result<BTreeMap<String, String>> {
        let plain = [
            ("footwork_version", self.footwork_version.clone()),
            ("task", self.task.clone()),
            ("step_s", self.step_s.to_string()),
            ("data_fingerprint", self.data_fingerprint.clone()),
            (METADATA_KEY, serde_json::to_string(self)?),
        ];
        let plain = plain
            .into_iter()
            .map(|(key, value)| (key.to_string(), value));
        Ok(plain.collect())
    }
}

/// A value whose numbers of 32 bits have no more digits than they need.
fn shortest(value: Value) -> Value {
    match value {
        Value::Number(number) => {
            let wide = number.as_f64().filter(|_| number.is_f64());
            let narrow = wide.map(|wide| wide as f32);
            let exact = narrow.filter(|narrow| Some(f64::from(*narrow)) == wide);
            let digits = exact.and_then(|narrow| narrow.to_string().parse::<f64>().ok());
            digits.map_or(Value::Number(number), Value::from)
        }
        Value::Array(values) => values.into_iter().map(shortest).collect(),
        Value::Object(values) => {
            let values = values.into_iter();
            values.map(|(key, value)| (key, shortest(value))).collect()
        }
        other => other,
    }
}

impl PortDescription {
    /// A vector.
    pub fn vector(name: &'static str, meaning: impl Into<String>, parts: Vec<VectorPart>) -> Self {
        let mut first = 0;
        let place = |part: VectorPart| {
            let placed = PlacedPart { first, part };
            first += placed.part.elements.len();
            placed
        };
        let parts = parts.into_iter().map(place).collect();
        PortDescription {
            shape: vec![first],
            parts,
            ..PortDescription::new(name, meaning)
        }
    }

    /// Maps of a shape.
    pub fn maps(name: &'static str, meaning: &str, shape: [usize; 3], maps: Value) -> Self {
        PortDescription {
            shape: shape.to_vec(),
            maps: Some(maps),
            ..PortDescription::new(name, meaning)
        }
    }

    fn new(name: &'static str, meaning: impl Into<String>) -> Self {
        PortDescription {
            name,
            shape: Vec::new(),
            dtype: "float32",
            meaning: meaning.into(),
            parts: Vec::new(),
            maps: None,
        }
    }
}
