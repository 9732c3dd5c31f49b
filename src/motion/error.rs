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
        "unknown skeleton: no joint found for {missing}; its joints are {joints}. Name them in a \
         roles file, a line like `left_foot = \"joint name\"` for each, and import with \
         `footwork data import --roles FILE`"
    )]
    MissingRoles { missing: String, joints: String },

    #[error(
        "the roles do not fit the skeleton: {problem}; give a roles file that names other joints"
    )]
    Roles { problem: String },

    #[error(
        "the unit of length is unclear: {problem}; give it with `footwork data import --unit METRES`"
    )]
    Unit { problem: String },

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
