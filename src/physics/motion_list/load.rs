//! From a list to a library of motions.

use super::error::{MotionListError, Result, UnusableClip};
use super::listed::{ListedClip, MotionList};
use super::options::MotionListOptions;
use super::prepare::{Prepared, prepare};
use crate::physics::model::Model;
use crate::physics::motion_library::MotionLibrary;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// What came of a recording, for people to read.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipReport {
    /// Name, that of its file.
    pub name: String,
    /// The label that the list gives it.
    pub kind: String,
    /// Indices of its motion and its mirrored copy in the library.
    pub motions: Range<usize>,
    /// From the first frame to the last, s.
    pub seconds: f32,
    /// How likely it is to be drawn, against the others.
    pub weight: f32,
    /// Fraction of all draws that are of it or of its mirrored copy.
    pub share: f32,
    /// Its fraction of the seconds of all recordings, mirrored copies left out.
    pub share_of_seconds: f32,
    /// 5th and 95th percentile over all frames, in the air or not, of the height of the lowest point
    /// of both feet, m.
    pub foot_height: [f32; 2],
    /// 5th and 95th percentile of the height at which the feet stand, m: see
    /// [`floor`](crate::physics::footing::floor).
    pub floor: [f32; 2],
    /// Whether its feet were brought to the ground wherever they stood; heights are those after it.
    pub grounded: bool,
    /// Fraction of the frames in which a joint is at the limit of its range. A straight elbow or knee is
    /// none.
    pub limits_hit: f32,
    /// T-pose frames dropped at both ends, in frames of the file.
    pub t_pose_frames: usize,
}

/// A list's motions.
#[derive(Clone, Debug)]
pub struct LoadedMotions {
    /// The motions with their weights and kinds, a mirrored copy right after its original.
    pub library: MotionLibrary,
    /// One for each recording.
    pub report: Vec<ClipReport>,
}

impl LoadedMotions {
    /// Length of all recordings, mirrored copies left out, s.
    pub fn seconds(&self) -> f32 {
        self.report.iter().map(|clip| clip.seconds).sum()
    }
}

impl MotionList {
    /// The motions of the list in the humanoid `model`. Skeletons may differ from clip to clip.
    ///
    /// # Errors
    /// Recordings that cannot be used, or not as the list says; see [`UnusableClip`].
    pub fn load(&self, model: &Arc<Model>, options: &MotionListOptions) -> Result<LoadedMotions> {
        let prepared: Vec<_> = self
            .clips
            .par_iter()
            .map(|clip| prepare(clip, model, options))
            .collect();
        let (mut clips, mut short) = (Vec::new(), Vec::new());
        for (clip, prepared) in self.clips.iter().zip(prepared) {
            match prepared {
                Ok(prepared) => clips.push((clip, prepared)),
                Err(UnusableClip::Short { clip, frames, .. }) if self.skip_short => {
                    short.push(format!("{clip} ({frames})"));
                }
                Err(UnusableClip::Motion(error)) if clip.line.is_none() => {
                    return Err(MotionListError::Recording(error));
                }
                Err(problem) => {
                    let place = self.place(clip);
                    return Err(MotionListError::Clip { place, problem });
                }
            }
        }
        if clips.is_empty() && !short.is_empty() {
            return Err(MotionListError::AllShort {
                path: self.path.clone(),
                frames: options.needed(),
            });
        }
        let mut loaded = collect(clips, model)?;
        if !short.is_empty() {
            let (frames, short) = (options.needed(), short.join(", "));
            let note = format!("left out for being shorter than {frames} frames at 30 Hz: {short}");
            loaded.library.notes.push(note);
        }
        Ok(loaded)
    }

    /// Where a clip is named.
    fn place(&self, clip: &ListedClip) -> String {
        match clip.line {
            Some(line) => format!("{}, line {line}", self.path.display()),
            None => clip.file.display().to_string(),
        }
    }
}

fn collect(clips: Vec<(&ListedClip, Prepared)>, model: &Arc<Model>) -> Result<LoadedMotions> {
    let (mut motions, mut weights, mut kinds) = (Vec::new(), Vec::new(), Vec::new());
    let (mut report, mut notes) = (Vec::new(), Vec::new());
    let seconds: f32 = clips.iter().map(|(_, clip)| clip.seconds()).sum();
    let weight: f32 = clips.iter().map(|(listed, _)| listed.weight).sum();
    for (listed, clip) in clips {
        let copies = clip.motions.len();
        report.push(ClipReport {
            name: clip.motions[0].name.clone(),
            kind: listed.kind.clone(),
            motions: motions.len()..motions.len() + copies,
            seconds: clip.seconds(),
            weight: listed.weight,
            share: listed.weight / weight,
            share_of_seconds: clip.seconds() / seconds,
            foot_height: clip.foot_height,
            floor: clip.floor,
            grounded: clip.grounded,
            limits_hit: clip.limits_hit,
            t_pose_frames: clip.t_pose_frames,
        });
        weights.extend(vec![listed.weight / copies as f32; copies]);
        kinds.extend(vec![listed.kind.clone(); copies]);
        motions.extend(clip.motions);
        notes.extend(clip.notes);
    }
    let library = MotionLibrary::new(motions, model)?;
    let mut library = library.weighted(&weights)?.with_kinds(kinds)?;
    library.notes = notes;
    Ok(LoadedMotions { library, report })
}
