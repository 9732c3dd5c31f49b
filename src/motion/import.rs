//! From files to clips: metres, y up, 30 Hz, without T-poses.

use super::bvh::{self, Recording};
use super::clip::Clip;
use super::error::{MotionError, MotionResult};
use super::manifest::{self, Entry, Manifest};
use super::mirror::mirror;
use super::resample::resample;
use super::roles::Roles;
use super::skeleton::Skeleton;
use super::{tpose, units};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Frames at 30 Hz that a clip needs: 30 of future for the last candidate, and the smoothing
/// window around them. Shorter clips are left out.
pub const MIN_FRAMES: usize = 61;

/// Choices of an import.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// Metres per file unit, instead of what the manifest says or the skeleton shows.
    pub unit_m: Option<f32>,
    /// A roles file ([`Roles::read`]), for skeletons whose names say too little.
    pub roles: Option<PathBuf>,
    /// Add the left/right mirrored copy of each clip, after all the clips themselves.
    pub mirror: bool,
}

/// Clips of one tree of joints (bone lengths may differ), and what their user should know.
#[derive(Clone, Debug)]
pub struct ImportedMotion {
    /// In the order of the file names.
    pub clips: Vec<Clip>,
    /// Joints of the feature, by number.
    pub roles: Roles,
    /// One sentence each: clips left out, T-poses dropped without a manifest, unusual units.
    pub notes: Vec<String>,
}

/// Imports one BVH file, or every BVH file directly in a folder.
///
/// A `manifest.csv` in the folder or the one above gives units, T-poses, licence and source of
/// the files it names; for others units and T-poses are found from the motion.
///
/// Errors: see [`MotionError`]; any file that cannot be read fails the whole import.
pub fn import(path: &Path, options: &ImportOptions) -> MotionResult<ImportedMotion> {
    check_unit(options)?;
    let files = files(path)?;
    let listing = Listing::beside(&files[0])?;
    // Results are put in order first, so that of several errors the first file's is shown.
    let recordings: Vec<MotionResult<Recording>> = files.par_iter().map(|f| bvh::read(f)).collect();
    let recordings: Vec<Recording> = recordings.into_iter().collect::<MotionResult<_>>()?;
    check_same_tree(&files, &recordings)?;

    let roles = roles_of(&files[0], &recordings[0].skeleton, options)?;
    let prepared: Vec<MotionResult<Prepared>> = files
        .par_iter()
        .zip(recordings)
        .map(|(file, recording)| {
            let entry = listing.entry(file);
            prepare(file, recording, entry, &roles, options).map_err(|error| error.within(file))
        })
        .collect();
    let prepared: Vec<Prepared> = prepared.into_iter().collect::<MotionResult<_>>()?;
    collect(path, prepared, roles, options)
}

/// One recording, prepared by itself.
#[derive(Clone, Debug)]
pub struct ImportedClip {
    /// The recording without its T-poses.
    pub clip: Clip,
    /// Joints of the feature, by number.
    pub roles: Roles,
    /// T-pose frames dropped at both ends, in frames of the file.
    pub t_pose_frames: usize,
    /// One sentence each: T-poses dropped without a manifest, an unusual unit.
    pub notes: Vec<String>,
}

/// Imports one BVH file as [`import`] does, whatever its length, and without a mirrored copy.
///
/// # Errors
/// See [`MotionError`].
pub fn import_file(file: &Path, options: &ImportOptions) -> MotionResult<ImportedClip> {
    check_unit(options)?;
    let listing = Listing::beside(file)?;
    let recording = bvh::read(file)?;
    let roles = roles_of(file, &recording.skeleton, options)?;
    let prepared = prepare(file, recording, listing.entry(file), &roles, options)
        .map_err(|error| error.within(file))?;
    Ok(ImportedClip {
        notes: notes(std::slice::from_ref(&prepared)),
        t_pose_frames: prepared.t_pose_frames,
        clip: prepared.clip,
        roles,
    })
}

fn roles_of(file: &Path, skeleton: &Skeleton, options: &ImportOptions) -> MotionResult<Roles> {
    match &options.roles {
        Some(roles) => Roles::read(roles, skeleton),
        None => Roles::find(skeleton).map_err(|error| error.within(file)),
    }
}

fn check_unit(options: &ImportOptions) -> MotionResult<()> {
    match options.unit_m {
        Some(unit) if !(unit.is_finite() && unit > 0.0) => Err(MotionError::Unit {
            problem: format!("{unit} was given, which is no length"),
        }),
        _ => Ok(()),
    }
}

/// The file itself, or the BVH files of a folder by name; never empty.
fn files(path: &Path) -> MotionResult<Vec<PathBuf>> {
    let unreadable = |error| MotionError::Read {
        path: path.to_path_buf(),
        error,
    };
    if !std::fs::metadata(path).map_err(unreadable)?.is_dir() {
        return Ok(vec![path.to_path_buf()]);
    }
    let mut files = Vec::new();
    let mut folders = Vec::new();
    for entry in std::fs::read_dir(path).map_err(unreadable)? {
        let file = entry.map_err(unreadable)?.path();
        if file.is_dir() {
            folders.push(file);
        } else if file
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("bvh"))
        {
            files.push(file);
        }
    }
    files.sort();
    if !files.is_empty() {
        return Ok(files);
    }
    folders.sort();
    let promising = folders.iter().find(|f| files_in(f) > 0);
    Err(MotionError::NoFiles {
        path: path.to_path_buf(),
        advice: match promising {
            Some(folder) => format!("folders are imported one by one: try {}", folder.display()),
            None => "give a folder that holds some, or a single .bvh file".to_string(),
        },
    })
}

/// How many BVH files a folder holds; none if it cannot be read.
fn files_in(folder: &Path) -> usize {
    files(folder).map_or(0, |files| files.len())
}

/// The manifest that covers a folder's files, and what it puts before their names.
#[derive(Default)]
struct Listing {
    manifest: Manifest,
    prefix: String,
}

impl Listing {
    /// The manifest in the file's folder, else the one above, else an empty one.
    fn beside(file: &Path) -> MotionResult<Listing> {
        let file = file.canonicalize().map_err(|error| MotionError::Read {
            path: file.to_path_buf(),
            error,
        })?;
        let mut prefix = String::new();
        for folder in file.ancestors().skip(1).take(2) {
            if let Some(manifest) = manifest::read(&folder.join("manifest.csv"))? {
                return Ok(Listing { manifest, prefix });
            }
            prefix = format!("{}/", name(folder.file_name()));
        }
        Ok(Listing::default())
    }

    fn entry(&self, file: &Path) -> Option<&Entry> {
        let key = format!("{}{}", self.prefix, name(file.file_name()));
        self.manifest.get(&key)
    }
}

fn name(name: Option<&std::ffi::OsStr>) -> String {
    name.map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

fn check_same_tree(files: &[PathBuf], recordings: &[Recording]) -> MotionResult<()> {
    let first = &recordings[0].skeleton;
    let other = recordings.iter().position(|r| !r.skeleton.same_tree(first));
    match other {
        None => Ok(()),
        Some(other) => Err(MotionError::Skeletons {
            first: files[0].clone(),
            second: files[other].clone(),
            difference: difference(first, &recordings[other].skeleton),
        }),
    }
}

/// The first joint in which two trees differ, in words.
fn difference(a: &Skeleton, b: &Skeleton) -> String {
    let parent = |s: &Skeleton, joint: usize| match s.parents[joint] {
        Some(parent) => format!("under '{}'", s.names[parent]),
        None => "at the root".to_string(),
    };
    let place = |s: &Skeleton, joint| format!("'{}' {}", s.names[joint], parent(s, joint));
    let common = a.joints().min(b.joints());
    (0..common)
        .map(|joint| (joint, place(a, joint), place(b, joint)))
        .find(|(_, a, b)| a != b)
        .map(|(joint, a, b)| format!("first in joint {}: {a} against {b}", joint + 1))
        .unwrap_or_else(|| format!("{} joints against {}", a.joints(), b.joints()))
}

/// One file, ready, and what is to be said about it.
struct Prepared {
    clip: Clip,
    /// T-pose frames that were dropped, in frames of the file.
    t_pose_frames: usize,
    /// Those of them that were detected rather than listed.
    detected: usize,
    /// The unit, if it is none of the usual ones and nobody gave it.
    odd_unit: Option<f32>,
}

fn prepare(
    file: &Path,
    recording: Recording,
    entry: Option<&Entry>,
    roles: &Roles,
    options: &ImportOptions,
) -> MotionResult<Prepared> {
    let frames = recording.frames();
    let (head, tail) = match entry {
        Some(entry) => (entry.skip_head, entry.skip_tail),
        None => tpose::find(&recording, roles),
    };
    let given = options.unit_m.or(entry.and_then(|entry| entry.unit_m));
    let unit = match given {
        Some(unit) => unit,
        None => units::find(&recording.skeleton, roles)?,
    };
    units::check(unit, &recording.skeleton, roles)?;
    let end = frames.saturating_sub(tail);
    let clip = recording.into_clip(&name(file.file_stem()), unit, head.min(end)..end);
    let mut clip = resample(clip);
    if let Some(entry) = entry {
        clip.source.clone_from(&entry.source);
        clip.licence.clone_from(&entry.licence);
    }
    Ok(Prepared {
        clip,
        t_pose_frames: head + tail,
        detected: entry.map_or(head + tail, |_| 0),
        odd_unit: (given.is_none() && !units::COMMON.contains(&unit)).then_some(unit),
    })
}

/// What is to be said about the recordings.
fn notes(prepared: &[Prepared]) -> Vec<String> {
    let mut notes = Vec::new();
    let detected = prepared.iter().filter(|p| p.detected > 0);
    let listed: Vec<String> = detected
        .map(|p| format!("{} ({})", p.clip.name, p.detected))
        .collect();
    if !listed.is_empty() {
        notes.push(format!("T-pose frames dropped from {}", listed.join(", ")));
    }
    for p in prepared {
        if let Some(unit) = p.odd_unit {
            let name = &p.clip.name;
            notes.push(format!("no usual unit fits {name}: scaled by {unit} for legs of 0.85 m; give its unit if that is wrong"));
        }
    }
    notes
}

fn collect(
    path: &Path,
    prepared: Vec<Prepared>,
    roles: Roles,
    options: &ImportOptions,
) -> MotionResult<ImportedMotion> {
    let mut notes = notes(&prepared);
    let clips = prepared.into_iter().map(|p| p.clip);
    let (mut clips, short): (Vec<Clip>, Vec<Clip>) = clips.partition(|c| c.frames() >= MIN_FRAMES);
    let short_frames: usize = short.iter().map(Clip::frames).sum();
    let short: Vec<String> = short
        .iter()
        .map(|c| format!("{} ({})", c.name, c.frames()))
        .collect();
    if !short.is_empty() {
        notes.push(format!("left out, {short_frames} frames in all, for being shorter than {MIN_FRAMES} frames at 30 Hz: {}", short.join(", ")));
    }
    if clips.is_empty() {
        return Err(MotionError::NoClips {
            path: path.to_path_buf(),
            reasons: notes.join("; "),
            frames: MIN_FRAMES,
        });
    }
    if options.mirror {
        let mirrored: Vec<MotionResult<Clip>> = clips.par_iter().map(mirror).collect();
        for clip in mirrored {
            let clip = clip.map_err(|error| error.within(path))?;
            let name = format!("{} mirrored", clip.name);
            clips.push(Clip { name, ..clip });
        }
    }
    Ok(ImportedMotion {
        clips,
        roles,
        notes,
    })
}
