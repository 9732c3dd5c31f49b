//! From one recording to its clip.

use super::folder::ClipReading;
use super::subject::Subject;
use crate::motion::clip::Clip;
use crate::motion::error::{MotionError, MotionResult};
use crate::motion::facing::backwards;
use crate::motion::findings::{ClipFindings, Finding, of_movement};
use crate::motion::jumps::{self, Continuity, Jump};
use crate::motion::resample::resample;
use crate::motion::roles::Roles;
use crate::motion::track::LimbTrack;
use crate::motion::up::{self, UpAxis};
use crate::motion::{tpose, units};
use std::ops::Range;

/// Jumps that an error lists before it counts the rest.
const LISTED: usize = 3;

/// One recording, ready, and what is to be said about it.
pub struct PreparedClip {
    pub clip: Clip,
    /// Frames of rest poses that were dropped, in frames of the file.
    pub t_pose_frames: usize,
    pub findings: Vec<Finding>,
    unit_m: f32,
    up: UpAxis,
}

impl PreparedClip {
    pub fn clip_findings(&self) -> ClipFindings {
        ClipFindings {
            unit_m: Some(self.unit_m),
            up: Some(self.up),
            notes: self.findings.iter().map(Finding::to_string).collect(),
        }
    }
}

/// Cuts a recording to its motion, in metres at 30 Hz.
///
/// # Errors
/// Its toes point backwards, or it jumps and nobody said that it may be cut.
pub fn prepare(
    subject: Subject,
    roles: &Roles,
    reading: &ClipReading,
    trim: bool,
) -> MotionResult<PreparedClip> {
    let Subject {
        file,
        name,
        entry,
        body,
        leg,
        mut findings,
        ..
    } = subject;
    let mut recording = body.recording;
    up::turn(&mut recording, reading.up);
    if reading.up != UpAxis::Y {
        let what = format!("turned, since up was {}", reading.up.name());
        findings.push(Finding::new(&what, ""));
    }
    if let Some(share) = backwards(&recording, roles) {
        let error = MotionError::Sides {
            percent: 100.0 * share,
            file: roles.exchanged().to_file(&recording.skeleton),
        };
        return Err(error.within(&file));
    }
    if let Some(remark) = units::remark(leg, reading.unit_m).filter(|_| reading.unit_found) {
        let what = "unusual size, give the unit with `--unit METRES` if it is wrong";
        findings.push(Finding::new(what, remark));
    }
    if reading.units_differ {
        let unit = format!("{} m", reading.unit_m);
        findings.push(Finding::new("different units in one folder", unit));
    }
    let (head, tail) = match &entry {
        Some(entry) => (entry.skip_head, entry.skip_tail),
        None => tpose::find(&recording, roles),
    };
    if entry.is_none() && head + tail > 0 {
        let what = "T-pose frames dropped";
        findings.push(Finding::new(what, (head + tail).to_string()));
    }
    let end = recording.frames().saturating_sub(tail);
    let moving = head.min(end)..end;
    let leg_m = leg * reading.unit_m;
    let mut track = LimbTrack::of(&recording, roles);
    let continuity = jumps::find(&track, moving.clone());
    findings.extend(leftovers(&moving, &continuity, leg_m));
    let keep = match continuity.inside.is_empty() {
        true => continuity.keep.clone(),
        false if trim => {
            let longest = jumps::longest(&continuity);
            findings.push(trimmed(&continuity, &longest, leg_m));
            longest
        }
        false => return Err(jumping(&continuity.inside, leg_m).within(&file)),
    };
    if let [(frame, length), ..] = continuity.twitches[..] {
        let metres = length * leg_m;
        let detail = format!("{metres:.2} m after frame {}", frame + 1);
        findings.push(Finding::new(
            "a hand or a foot jumps, as of a marker that was lost",
            detail,
        ));
    }
    track.keep(keep.clone());
    findings.extend(of_movement(&track, leg_m));
    let clip = recording.into_clip(&name, reading.unit_m, keep);
    let mut clip = resample(clip);
    if let Some(entry) = entry {
        clip.source = entry.source;
        clip.licence = entry.licence;
    }
    Ok(PreparedClip {
        clip,
        t_pose_frames: head + tail + moving.len() - continuity.keep.len(),
        findings,
        unit_m: reading.unit_m,
        up: reading.up,
    })
}

/// What was cut off at the ends.
fn leftovers(moving: &Range<usize>, continuity: &Continuity, leg_m: f32) -> Option<Finding> {
    let head = continuity.keep.start - moving.start;
    let tail = moving.end - continuity.keep.end;
    let parts = [(head, "at the start"), (tail, "at the end")];
    let parts = parts.into_iter().filter(|(frames, _)| *frames > 0);
    let parts: Vec<String> = parts
        .map(|(frames, end)| format!("{frames} {end}"))
        .collect();
    let farthest = continuity.cut.iter().map(Jump::length).fold(0.0, f32::max) * leg_m;
    let what = "rest frames dropped, from which the motion jumps";
    (!parts.is_empty())
        .then(|| Finding::new(what, format!("{}, {farthest:.2} m", parts.join(", "))))
}

fn trimmed(continuity: &Continuity, longest: &Range<usize>, leg_m: f32) -> Finding {
    let dropped = continuity.keep.len() - longest.len();
    let detail = format!("{dropped} frames, {}", list(&continuity.inside, leg_m));
    Finding::new("trimmed to the longest piece without a jump", detail)
}

fn jumping(jumps: &[Jump], leg_m: f32) -> MotionError {
    let jumps = list(jumps, leg_m);
    MotionError::Jumps {
        problem: format!(
            "the motion jumps as no body can: {jumps}; takes that were joined, or moments at which the actor was lost"
        ),
    }
}

fn list(jumps: &[Jump], leg_m: f32) -> String {
    let one = |jump: &Jump| {
        let metres = jump.length() * leg_m;
        // From 1, as people count the rows of a file.
        format!("{metres:.2} m after frame {}", jump.after + 1)
    };
    let first: Vec<String> = jumps.iter().take(LISTED).map(one).collect();
    match jumps.len().saturating_sub(LISTED) {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}
