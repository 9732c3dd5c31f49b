//! Errors between a file and a motion.

use crate::container::StoreError;
use std::path::{Path, PathBuf};

/// A result of reading or importing motion.
pub type MotionResult<T> = Result<T, MotionError>;

/// Each message says what is wrong, where, and what to do about it.
#[allow(missing_docs, reason = "the messages say what variants and fields are")]
#[derive(Debug, thiserror::Error)]
pub enum MotionError {
    #[error("cannot read {}: {error}; check that it exists and may be read", .path.display())]
    Read {
        path: PathBuf,
        error: std::io::Error,
    },

    #[error(transparent)]
    Write(#[from] StoreError),

    #[error("{} holds more than {limit} bytes, too many for one file of motion; cut it into shorter recordings", .path.display())]
    TooLarge { path: PathBuf, limit: u64 },

    /// A BVH file that breaks the format; `problem` ends with what to do where that is not plain.
    #[error("{}, line {line}: {problem}", .path.display())]
    Bvh {
        path: PathBuf,
        line: usize,
        problem: String,
    },

    /// A clip that has no faithful form as a BVH file.
    #[error("cannot write the clip '{clip}' as BVH: {problem}")]
    Unwritable { clip: String, problem: String },

    #[error("{}, line {line}: {problem}; correct that line of the manifest, or move the manifest away to have T-poses and units detected", .path.display())]
    Manifest {
        path: PathBuf,
        line: usize,
        problem: String,
    },

    #[error("{}: {problem}", .path.display())]
    RolesFile { path: PathBuf, problem: String },

    #[error(
        "unknown skeleton: no joint found for {missing}; its joints are {joints}. Complete these \
         lines in a roles file, and import with `footwork data import --roles FILE`:\n\n{file}"
    )]
    MissingRoles {
        missing: Box<str>,
        joints: Box<str>,
        file: Box<str>,
    },

    #[error(
        "the roles do not fit the skeleton: {problem}; give a roles file that names other joints"
    )]
    Roles { problem: String },

    #[error(
        "the unit of length is unclear: {problem}; give it with `footwork data import --unit METRES`"
    )]
    Unit { problem: String },

    #[error(
        "it is unclear which way is up: {problem}; say so with `footwork data import --up AXIS`"
    )]
    Up { problem: String },

    #[error(
        "left and right are exchanged: in {percent:.0} % of the frames the toes point backwards. These \
         roles exchange them; put them in a roles file, and import with `footwork data import --roles \
         FILE`:\n\n{file}"
    )]
    Sides { percent: f32, file: String },

    #[error(
        "{problem}; `footwork data import --trim` cuts recordings where they jump, and keeps the longest piece of each"
    )]
    Jumps { problem: String },

    #[error(
        "the joint '{joint}' moves by {moves} against its parent; bones must keep their length: export rotations only below the root"
    )]
    Stretching { joint: String, moves: f32 },

    #[error(
        "cannot mirror: {problem}; import without mirroring, or rename the joints so that left and right pair up"
    )]
    Mirror { problem: String },

    #[error("two different skeletons in one folder: {} and {} differ, {difference}; put them in folders of their own", .first.display(), .second.display())]
    Skeletons {
        first: PathBuf,
        second: PathBuf,
        difference: String,
    },

    #[error("no .bvh file in {}; {advice}", .path.display())]
    NoFiles { path: PathBuf, advice: String },

    #[error("no usable clip in {}: {reasons}; each needs {frames} frames at 30 Hz besides its T-poses", .path.display())]
    NoClips {
        path: PathBuf,
        reasons: String,
        frames: usize,
    },

    #[error("{} of {total} files in {} cannot be used; correct or remove them, or leave them out with `footwork data import --skip-bad`:\n  {}", .bad, .path.display(), .problems.join("\n  "))]
    BadFiles {
        path: PathBuf,
        bad: usize,
        total: usize,
        problems: Vec<String>,
    },

    /// An error of a function that knows no files, met while working on this one.
    #[error("{}: {error}", .path.display())]
    In {
        path: PathBuf,
        error: Box<MotionError>,
    },
}

impl MotionError {
    /// This error, with the file in which it was met.
    pub fn within(self, path: &Path) -> MotionError {
        MotionError::In {
            path: path.to_path_buf(),
            error: Box::new(self),
        }
    }
}
