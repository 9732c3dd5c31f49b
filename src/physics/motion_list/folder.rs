//! Recordings in folders.

use super::error::{MotionListError, Result, UnusableClip};
use super::listed::{ListedClip, MotionList};
use crate::motion::files::is_hidden;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The recordings directly in a folder.
pub fn list(folder: &Path) -> Result<MotionList> {
    let files = recordings(folder).map_err(|error| MotionListError::Read {
        path: folder.to_path_buf(),
        error,
    })?;
    // A text of another kind, like a licence, is no recording.
    let files = files
        .into_iter()
        .filter(|file| is_bvh(file) || is_json(file));
    let clips: Vec<ListedClip> = files.map(ListedClip::of).collect();
    match clips.is_empty() {
        false => Ok(MotionList {
            clips,
            path: folder.to_path_buf(),
            skip_short: true,
        }),
        true => Err(MotionListError::NoFiles {
            path: folder.to_path_buf(),
        }),
    }
}

/// The file of a list, in `folder`: the one so called, or else the only recording whose name begins so.
pub fn find(folder: &Path, file: &Path) -> std::result::Result<PathBuf, UnusableClip> {
    let exact = folder.join(file);
    if exact.is_file() {
        return Ok(exact);
    }
    let inside = exact.parent().unwrap_or(folder);
    let candidates = recordings(inside).map_err(|error| UnusableClip::Folder {
        file: file.to_path_buf(),
        folder: inside.to_path_buf(),
        error,
    })?;
    // What follows a dot may be part of the name.
    let kind = file.extension().filter(|_| is_bvh(file) || is_text(file));
    let start = name(kind.map_or(file.file_name(), |_| file.file_stem()));
    let matching = candidates.into_iter().filter(|candidate| {
        let same_kind = kind.is_none_or(|kind| candidate.extension() == Some(kind));
        same_kind && name(candidate.file_name()).starts_with(&start)
    });
    let mut matching: Vec<PathBuf> = matching.collect();
    let whole = |file: &PathBuf| name(file.file_stem()) == start;
    let chosen = matching.iter().position(whole).unwrap_or_default();
    match matching.len() {
        0 => Err(UnusableClip::Missing {
            start,
            file: file.to_path_buf(),
            folder: inside.to_path_buf(),
        }),
        2.. if !matching.iter().any(whole) => Err(UnusableClip::Ambiguous {
            file: file.to_path_buf(),
            folder: inside.to_path_buf(),
            candidates: matching.iter().map(|file| name(file.file_name())).collect(),
        }),
        _ => Ok(matching.swap_remove(chosen)),
    }
}

/// Files that may be recordings directly in a folder, by name.
fn recordings(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let files = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    let mut files = files.collect::<std::io::Result<Vec<PathBuf>>>()?;
    let is_recording = |file: &PathBuf| is_bvh(file) || is_text(file);
    files.retain(|file| is_recording(file) && !is_hidden(file) && file.is_file());
    files.sort();
    Ok(files)
}

fn is_bvh(file: &Path) -> bool {
    ends(file, "bvh")
}

/// Whether a file may be DeepMimic's.
pub fn is_text(file: &Path) -> bool {
    ends(file, "txt")
}

fn ends(file: &Path, end: &str) -> bool {
    file.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(end))
}

/// Whether a file begins like JSON; one that cannot be read counts, so that it is told of.
fn is_json(file: &Path) -> bool {
    let mut head = [0; 64];
    let read = std::fs::File::open(file).and_then(|mut file| file.read(&mut head));
    read.is_err() || head.trim_ascii_start().first() == Some(&b'{')
}

fn name(name: Option<&std::ffi::OsStr>) -> String {
    name.map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}
