//! Which files an import reads.

use super::error::{MotionError, MotionResult};
use super::findings::listed;
use std::path::{Path, PathBuf};

/// Levels below sub-folders that are searched for files to mention.
const MENTIONED: usize = 1;

/// The files of an import.
pub struct BvhFiles {
    /// By path; never empty.
    pub files: Vec<PathBuf>,
    /// What was passed over.
    pub notes: Vec<String>,
}

/// The file itself, or the BVH files of a folder. Names that begin with a dot are no recordings: macOS
/// leaves such beside others. With `recursive`, those of its sub-folders too; links to folders are
/// not followed.
///
/// # Errors
/// A path that cannot be read, a folder without BVH files.
pub fn find(path: &Path, recursive: bool) -> MotionResult<BvhFiles> {
    if !std::fs::metadata(path)
        .map_err(|error| unreadable(path, error))?
        .is_dir()
    {
        return Ok(BvhFiles {
            files: vec![path.to_path_buf()],
            notes: Vec::new(),
        });
    }
    let Listed { mut files, folders } = list(path)?;
    let mut below = Vec::new();
    for folder in &folders {
        // What cannot be read is an error only where it was asked for.
        match (
            recursive,
            files_below(folder, if recursive { usize::MAX } else { MENTIONED }),
        ) {
            (_, Ok(files)) => below.push((folder, files)),
            (true, Err(error)) => return Err(error),
            (false, Err(_)) => {}
        }
    }
    below.retain(|(_, files)| !files.is_empty());
    if recursive {
        files.extend(below.drain(..).flat_map(|(_, files)| files));
    }
    if files.is_empty() {
        return Err(MotionError::NoFiles {
            path: path.to_path_buf(),
            advice: match below.first() {
                Some((folder, _)) => format!(
                    "its sub-folders hold some: read them all with `--recursive`, or try {}",
                    folder.display()
                ),
                None => "give a folder that holds some, or a single .bvh file".to_string(),
            },
        });
    }
    let passed_over: usize = below.iter().map(|(_, files)| files.len()).sum();
    let names: Vec<String> = below.iter().map(|(folder, _)| name(folder)).collect();
    let note = format!(
        "recordings in sub-folders were not read: {passed_over} in {}; `--recursive` reads them",
        listed(&names)
    );
    Ok(BvhFiles {
        files,
        notes: if passed_over > 0 {
            vec![note]
        } else {
            Vec::new()
        },
    })
}

/// What is directly in a folder, by name.
struct Listed {
    files: Vec<PathBuf>,
    folders: Vec<PathBuf>,
}

fn list(path: &Path) -> MotionResult<Listed> {
    let (mut files, mut folders) = (Vec::new(), Vec::new());
    for entry in std::fs::read_dir(path).map_err(|error| unreadable(path, error))? {
        let entry = entry.map_err(|error| unreadable(path, error))?;
        let found = entry.path();
        if is_hidden(&found) {
            continue;
        }
        let is_bvh = found
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("bvh"));
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            folders.push(found);
        } else if is_bvh && !found.is_dir() {
            files.push(found);
        }
    }
    files.sort();
    folders.sort();
    Ok(Listed { files, folders })
}

/// All BVH files in a folder and `depth` levels below.
fn files_below(folder: &Path, depth: usize) -> MotionResult<Vec<PathBuf>> {
    let (mut files, mut open) = (Vec::new(), vec![(folder.to_path_buf(), depth)]);
    while let Some((folder, depth)) = open.pop() {
        let listed = list(&folder)?;
        files.extend(listed.files);
        if let Some(depth) = depth.checked_sub(1) {
            open.extend(listed.folders.into_iter().map(|folder| (folder, depth)));
        }
    }
    files.sort();
    Ok(files)
}

/// Whether a file's name begins with a dot.
pub fn is_hidden(path: &Path) -> bool {
    name(path).starts_with('.')
}

/// The last part of a path.
pub fn name(path: &Path) -> String {
    let name = path.file_name();
    name.map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

fn unreadable(path: &Path, error: std::io::Error) -> MotionError {
    MotionError::Read {
        path: path.to_path_buf(),
        error,
    }
}
