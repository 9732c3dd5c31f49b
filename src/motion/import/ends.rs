//! The frames of a recording without what stands before and after the motion.

use crate::motion::bvh::Recording;
use crate::motion::findings::Finding;
use crate::motion::jumps::{self, Continuity, Jump};
use crate::motion::roles::Roles;
use crate::motion::tpose;
use crate::motion::track::LimbTrack;
use std::ops::Range;

/// What is left of a recording, and what was dropped at its ends.
pub struct Ends {
    /// The jumps in what is left, and its frames.
    pub continuity: Continuity,
    /// Frames of T-poses.
    t_pose: usize,
    /// Frames of other rest poses, or of other takes, at the start and at the end.
    rest: [usize; 2],
    /// The farthest jump between them and the motion, leg lengths.
    farthest: f32,
}

impl Ends {
    /// Looks for T-poses, unless a manifest tells of them, and for what the motion jumps from or to, until
    /// there is nothing more: a rest pose may stand before a T-pose.
    pub fn find(
        recording: &Recording,
        roles: &Roles,
        track: &LimbTrack,
        within: Range<usize>,
        is_listed: bool,
    ) -> Ends {
        let mut ends = Ends {
            continuity: jumps::find(track, within.clone()),
            t_pose: 0,
            rest: [0; 2],
            farthest: 0.0,
        };
        let mut left = within;
        loop {
            let before = left.clone();
            if !is_listed {
                let (head, tail) = tpose::find_within(recording, roles, left.clone());
                ends.t_pose += head + tail;
                left = left.start + head..left.end - tail;
            }
            ends.continuity = jumps::find(track, left.clone());
            let keep = ends.continuity.keep.clone();
            ends.rest[0] += keep.start - left.start;
            ends.rest[1] += left.end - keep.end;
            let jumps = ends.continuity.cut.iter().map(Jump::length);
            ends.farthest = jumps.fold(ends.farthest, f32::max);
            left = keep;
            if left == before {
                return ends;
            }
        }
    }

    /// Frames dropped in all.
    pub fn dropped(&self) -> usize {
        self.t_pose + self.rest[0] + self.rest[1]
    }

    /// What was dropped, in words; a leg is `leg_m` long.
    pub fn findings(&self, leg_m: f32) -> Vec<Finding> {
        let mut findings = Vec::new();
        if self.t_pose > 0 {
            findings.push(Finding::new(
                "T-pose frames dropped",
                self.t_pose.to_string(),
            ));
        }
        let parts = self.rest.into_iter().zip(["at the start", "at the end"]);
        let parts = parts.filter(|(frames, _)| *frames > 0);
        let parts: Vec<String> = parts
            .map(|(frames, end)| format!("{frames} {end}"))
            .collect();
        if !parts.is_empty() {
            let metres = self.farthest * leg_m;
            let what = "rest frames dropped, from which the motion jumps";
            let detail = format!("{}, {metres:.2} m", parts.join(", "));
            findings.push(Finding::new(what, detail));
        }
        findings
    }
}
