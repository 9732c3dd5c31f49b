//! What an import finds in a clip, for its user to know.

use super::track::LimbTrack;
use super::up::UpAxis;
use serde::{Deserialize, Serialize};
use std::fmt::{Display, Formatter};

/// One thing found in one clip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// What was found, in words that are the same for all clips of which it is true.
    pub what: String,
    /// Figures of this clip; empty if there are none.
    pub detail: String,
}

impl Finding {
    pub(super) fn new(what: &str, detail: impl Into<String>) -> Finding {
        Finding {
            what: what.to_string(),
            detail: detail.into(),
        }
    }
}

impl Display for Finding {
    fn fmt(&self, f: &mut Formatter) -> std::fmt::Result {
        match self.detail.is_empty() {
            true => f.write_str(&self.what),
            false => write!(f, "{}: {}", self.what, self.detail),
        }
    }
}

/// How a clip was read, and what was found in it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ClipFindings {
    /// Metres of one unit of its file.
    pub unit_m: Option<f32>,
    /// The axis that was up in its file.
    pub up: Option<UpAxis>,
    /// One sentence each.
    pub notes: Vec<String>,
}

/// Names that a note lists before it counts the rest.
const LISTED: usize = 8;

/// One note for each thing found, with the clips of which it is true.
pub fn summary<'a>(clips: impl Iterator<Item = (&'a str, &'a [Finding])>) -> Vec<String> {
    let mut notes: Vec<(&str, Vec<String>)> = Vec::new();
    for (name, findings) in clips {
        for finding in findings {
            let clip = match finding.detail.is_empty() {
                true => name.to_string(),
                false => format!("{name} ({})", finding.detail),
            };
            match notes.iter_mut().find(|(what, _)| *what == finding.what) {
                Some((_, clips)) => clips.push(clip),
                None => notes.push((&finding.what, vec![clip])),
            }
        }
    }
    let notes = notes.into_iter();
    notes
        .map(|(what, clips)| format!("{what}: {}", listed(&clips)))
        .collect()
}

/// The first of many names, and how many more there are.
pub fn listed(names: &[String]) -> String {
    match names.len().checked_sub(LISTED) {
        None | Some(0) => names.join(", "),
        Some(more) => format!("{} and {more} more", names[..LISTED].join(", ")),
    }
}

/// Hips that never leave a circle of this size stay in place, leg lengths.
const IN_PLACE: f32 = 0.05;

/// Feet that go so far against the hips take steps, leg lengths.
const STEPPING: f32 = 0.3;

/// Nothing that lives keeps so still, leg lengths.
const FROZEN: f32 = 1e-3;

/// The feet of who stands on the ground come as near to it, leg lengths.
const OFF_GROUND: f32 = 0.35;

/// What is strange in the movement of a clip whose legs are `leg_m` long.
pub fn of_movement(track: &LimbTrack, leg_m: f32) -> Vec<Finding> {
    let travel =
        extent(track.hips.iter().map(|p| p.x)).hypot(extent(track.hips.iter().map(|p| p.z)));
    let swing = |end: usize| {
        let [x, y, z] = [0, 1, 2].map(|axis| extent(track.ends.iter().map(|ends| ends[end][axis])));
        x.hypot(y).hypot(z)
    };
    let steps = swing(0).min(swing(1));
    let mut findings = Vec::new();
    if travel < FROZEN && (0..4).all(|end| swing(end) < FROZEN) {
        findings.push(Finding::new("nothing moves", ""));
    } else if travel < IN_PLACE && steps > STEPPING {
        let metres = travel * leg_m;
        findings.push(Finding::new(
            "the feet step but the root stays in place, so no controller can be trained of it; export with root motion",
            format!("moves by {metres:.2} m"),
        ));
    }
    let floor = percentile(track.lowest.clone(), 0.05);
    if floor.abs() > OFF_GROUND {
        let side = if floor > 0.0 { "above" } else { "below" };
        let metres = floor.abs() * leg_m;
        findings.push(Finding::new(
            "the feet do not reach the ground",
            format!("lowest {metres:.2} m {side} it"),
        ));
    }
    findings
}

fn extent(values: impl Iterator<Item = f32>) -> f32 {
    let (low, high) = values.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    (high - low).max(0.0)
}

fn percentile(mut values: Vec<f32>, share: f32) -> f32 {
    let last = values.len().saturating_sub(1);
    if values.is_empty() {
        return 0.0;
    }
    let (_, value, _) =
        values.select_nth_unstable_by((share * last as f32) as usize, f32::total_cmp);
    *value
}
