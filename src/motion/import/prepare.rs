//! From one recording to its clip.

use super::ends::Ends;
use super::folder::ClipReading;
use super::subject::Subject;
use crate::motion::bvh::Recording;
use crate::motion::clip::Clip;
use crate::motion::error::{MotionError, MotionResult};
use crate::motion::facing::backwards;
use crate::motion::findings::{ClipFindings, Finding, of_movement};
use crate::motion::jumps::{self, Continuity, Jump};
use crate::motion::manifest::Entry;
use crate::motion::resample::resample;
use crate::motion::roles::Roles;
use crate::motion::track::LimbTrack;
use crate::motion::units;
use crate::motion::up::{self, UpAxis};
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
    let within = |error: MotionError| error.within(&file);
    let mut recording = body.recording;
    up::turn(&mut recording, reading.up);
    check_sides(&recording, roles).map_err(within)?;
    findings.extend(of_reading(reading, leg));
    let listed = listed_frames(recording.frames(), entry.as_ref());
    let leg_m = leg * reading.unit_m;
    let mut track = LimbTrack::of(&recording, roles);
    let ends = Ends::find(&recording, roles, &track, listed.clone(), entry.is_some());
    findings.extend(ends.findings(leg_m));
    findings.extend(twitch(&ends.continuity, leg_m));
    let keep = if ends.continuity.inside.is_empty() {
        ends.continuity.keep.clone()
    } else if trim {
        let longest = jumps::longest(&ends.continuity);
        findings.push(trimmed(&ends.continuity, &longest, leg_m));
        longest
    } else {
        return Err(within(jumping(&ends.continuity.inside, leg_m)));
    };
    track.keep(keep.clone());
    findings.extend(of_movement(&track, leg_m));
    let t_pose_frames = recording.frames() - listed.len() + ends.dropped();
    let mut clip = resample(recording.into_clip(&name, reading.unit_m, keep));
    if let Some(entry) = entry {
        clip.source = entry.source;
        clip.licence = entry.licence;
    }
    Ok(PreparedClip {
        clip,
        t_pose_frames,
        findings,
        unit_m: reading.unit_m,
        up: reading.up,
    })
}

fn check_sides(recording: &Recording, roles: &Roles) -> MotionResult<()> {
    match backwards(recording, roles) {
        None => Ok(()),
        Some(share) => Err(MotionError::Sides {
            percent: 100.0 * share,
            file: roles.exchanged().to_file(&recording.skeleton),
        }),
    }
}

/// What was found about the axes and the unit.
fn of_reading(reading: &ClipReading, leg: f32) -> Vec<Finding> {
    let mut findings = Vec::new();
    if reading.up != UpAxis::Y {
        let what = format!("turned, since up was {}", reading.up.name());
        findings.push(Finding::new(&what, ""));
    }
    if let Some(remark) = units::remark(leg, reading.unit_m).filter(|_| reading.unit_found) {
        let what = "unusual size, give the unit with `--unit METRES` if it is wrong";
        findings.push(Finding::new(what, remark));
    }
    if reading.units_differ {
        let unit = format!("{} m", reading.unit_m);
        findings.push(Finding::new("different units in one folder", unit));
    }
    findings
}

/// The frames that a manifest leaves; without one, all.
fn listed_frames(frames: usize, entry: Option<&Entry>) -> Range<usize> {
    let [head, tail] = entry.map_or([0, 0], |entry| [entry.skip_head, entry.skip_tail]);
    let end = frames.saturating_sub(tail);
    head.min(end)..end
}

fn twitch(continuity: &Continuity, leg_m: f32) -> Option<Finding> {
    let (frame, length) = continuity.twitches.first()?;
    let metres = length * leg_m;
    let what = "a hand or a foot jumps, as of a marker that was lost";
    let detail = format!("{metres:.2} m after frame {}", frame + 1);
    Some(Finding::new(what, detail))
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
