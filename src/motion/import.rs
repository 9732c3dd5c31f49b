//! From files to clips: the body alone, metres, y up, 30 Hz, without rest poses.

mod bad_files;
mod ends;
mod folder;
mod options;
mod prepare;
mod subject;

pub use options::ImportOptions;

use super::clip::Clip;
use super::error::{MotionError, MotionResult};
use super::files::{self, BvhFiles};
use super::findings::{ClipFindings, summary};
use super::listing::Listings;
use super::mirror::mirror;
use super::roles::Roles;
use bad_files::BadFiles;
use folder::{FolderEvidence, check_tree, usual};
use prepare::{PreparedClip, prepare};
use rayon::prelude::*;
use std::path::Path;
use subject::Subject;

/// Frames at 30 Hz that a clip needs: 30 of future for the last candidate, and the smoothing
/// window around them. Shorter clips are left out.
pub const MIN_FRAMES: usize = 61;

/// Clips of one tree of joints (bone lengths may differ), and what their user should know.
#[derive(Clone, Debug)]
pub struct ImportedMotion {
    /// In the order of the file names.
    pub clips: Vec<Clip>,
    /// How each clip was read, in the same order.
    pub findings: Vec<ClipFindings>,
    /// Joints of the feature, by number.
    pub roles: Roles,
    /// One sentence each: clips left out, rest poses dropped, unusual units, what is strange.
    pub notes: Vec<String>,
}

/// Imports one BVH file, or every BVH file directly in a folder.
///
/// A `manifest.csv` in the folder or the one above gives units, T-poses, licence and source of
/// the files it names; for others units and T-poses are found from the motion.
///
/// Errors: see [`MotionError`]; files that cannot be used are named all at once.
pub fn import(path: &Path, options: &ImportOptions) -> MotionResult<ImportedMotion> {
    check_unit(options)?;
    let BvhFiles { files, mut notes } = files::find(path, options.recursive)?;
    let listings = Listings::of(&files)?;
    notes.extend(listings.notes());
    let mut bad = BadFiles::default();
    let read: Vec<_> = files
        .par_iter()
        .map(|file| {
            let entry = listings.entry(file);
            Subject::read(file, clip_name(path, file), entry, options.roles.as_deref())
        })
        .collect();
    let subjects = bad.sort_out(read.into_iter().enumerate());
    let known: Vec<&Subject> = subjects.iter().map(|(_, subject)| subject).collect();
    let Some(usual) = usual(&known) else {
        return Err(bad.into_error(path, files.len()));
    };
    let (roles, common) = (usual.body.roles, FolderEvidence::of(&known, options));
    let reading =
        |subject| check_tree(subject, usual).and_then(|()| common.reading(subject, options));
    let readings: Vec<_> = known.into_iter().map(reading).collect();
    let subjects = subjects.into_iter().zip(readings);
    let subjects = bad.sort_out(
        subjects
            .map(|((file, subject), reading)| (file, reading.map(|reading| (subject, reading)))),
    );
    let prepared: Vec<_> = subjects
        .into_par_iter()
        .map(|(file, (subject, reading))| (file, prepare(subject, &roles, &reading, options.trim)))
        .collect();
    let prepared = bad.sort_out(prepared.into_iter());
    notes.extend(bad.settle(path, files.len(), options.skip_bad && !prepared.is_empty())?);
    let prepared = prepared.into_iter().map(|(_, prepared)| prepared).collect();
    collect(path, prepared, notes, roles, options)
}

/// One recording, prepared by itself.
#[derive(Clone, Debug)]
pub struct ImportedClip {
    /// The recording without its T-poses.
    pub clip: Clip,
    /// Joints of the feature, by number.
    pub roles: Roles,
    /// Frames of T-poses and other rest poses dropped at both ends, in frames of the file.
    pub t_pose_frames: usize,
    /// One sentence each: rest poses dropped, an unusual unit, what is strange.
    pub notes: Vec<String>,
}

/// Imports one BVH file as [`import`] does, whatever its length, and without a mirrored copy.
///
/// # Errors
/// See [`MotionError`].
pub fn import_file(file: &Path, options: &ImportOptions) -> MotionResult<ImportedClip> {
    check_unit(options)?;
    let files = [file.to_path_buf()];
    let listings = Listings::of(&files)?;
    let mut notes = listings.notes();
    let entry = listings.entry(file);
    let subject = Subject::read(file, clip_name(file, file), entry, options.roles.as_deref())?;
    let roles = subject.body.roles;
    let reading = FolderEvidence::of(&[&subject], options).reading(&subject, options)?;
    let prepared = prepare(subject, &roles, &reading, options.trim)?;
    notes.extend(found(std::slice::from_ref(&prepared)));
    Ok(ImportedClip {
        notes,
        t_pose_frames: prepared.t_pose_frames,
        clip: prepared.clip,
        roles,
    })
}

fn check_unit(options: &ImportOptions) -> MotionResult<()> {
    match options.unit_m {
        Some(unit) if !(unit.is_finite() && unit > 0.0) => Err(MotionError::Unit {
            problem: format!("{unit} was given, which is no length"),
        }),
        _ => Ok(()),
    }
}

/// A file's path below what is imported, without its ending.
fn clip_name(path: &Path, file: &Path) -> String {
    let below = file.strip_prefix(path).unwrap_or(file).with_extension("");
    match below.components().count() {
        0 | 1 => files::name(&file.with_extension("")),
        _ if file == path => files::name(&below),
        _ => below.to_string_lossy().into_owned(),
    }
}

/// What is to be said about the recordings.
fn found(prepared: &[PreparedClip]) -> Vec<String> {
    summary(prepared.iter().map(|p| (&*p.clip.name, &*p.findings)))
}

fn collect(
    path: &Path,
    prepared: Vec<PreparedClip>,
    mut notes: Vec<String>,
    roles: Roles,
    options: &ImportOptions,
) -> MotionResult<ImportedMotion> {
    let found = found(&prepared);
    let (usable, short): (Vec<PreparedClip>, Vec<PreparedClip>) = prepared
        .into_iter()
        .partition(|p| p.clip.frames() >= MIN_FRAMES);
    let short_frames: usize = short.iter().map(|p| p.clip.frames()).sum();
    let short: Vec<String> = short
        .iter()
        .map(|p| format!("{} ({})", p.clip.name, p.clip.frames()))
        .collect();
    if !short.is_empty() {
        notes.push(format!("left out, {short_frames} frames in all, for being shorter than {MIN_FRAMES} frames at 30 Hz: {}", short.join(", ")));
    }
    notes.extend(found);
    if usable.is_empty() {
        return Err(MotionError::NoClips {
            path: path.to_path_buf(),
            reasons: notes.join("; "),
            frames: MIN_FRAMES,
        });
    }
    let mut findings: Vec<ClipFindings> = usable.iter().map(PreparedClip::clip_findings).collect();
    let mut clips: Vec<Clip> = usable.into_iter().map(|p| p.clip).collect();
    if options.mirror {
        let mirrored: Vec<MotionResult<Clip>> = clips.par_iter().map(mirror).collect();
        for clip in mirrored {
            let clip = clip.map_err(|error| error.within(path))?;
            let name = format!("{} mirrored", clip.name);
            clips.push(Clip { name, ..clip });
        }
        findings.extend(findings.clone());
    }
    Ok(ImportedMotion {
        clips,
        findings,
        roles,
        notes,
    })
}
