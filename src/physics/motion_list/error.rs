//! Why a list of recordings is of no use.

use crate::motion::error as motion;
use crate::physics::deepmimic::DeepMimicError;
use crate::physics::mirror::MirrorError;
use crate::physics::motion_library::MotionLibraryError;
use crate::physics::retarget::RetargetError;
use std::path::PathBuf;

/// A result of reading a list of recordings.
pub type Result<T> = std::result::Result<T, MotionListError>;

/// Why a list of recordings is of no use.
#[derive(Debug, thiserror::Error)]
pub enum MotionListError {
    /// A list or a folder that cannot be read.
    #[error("cannot read {}: {error}; check that it exists and may be read", .path.display())]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// Why it cannot be read.
        error: std::io::Error,
    },
    /// A file that is not TOML, or with keys or values that lists do not have.
    #[error("{}, line {line}: {problem}", .path.display())]
    Toml {
        /// The list.
        path: PathBuf,
        /// Line of the mistake, from 1.
        line: usize,
        /// What is wrong there.
        problem: String,
    },
    /// A list without recordings.
    #[error("{} names no clip: add a table [[clip]] with `file = \"...\"` for each recording", .path.display())]
    Empty {
        /// The list.
        path: PathBuf,
    },
    /// A folder without recordings.
    #[error("no recording in {}: neither a .bvh file nor DeepMimic's JSON in a .txt file; sub-folders are not searched", .path.display())]
    NoFiles {
        /// The folder.
        path: PathBuf,
    },
    /// A folder whose recordings are all too short.
    #[error("no recording in {} is long enough: each needs {frames} frames at 30 Hz besides its T-poses", .path.display())]
    AllShort {
        /// The folder.
        path: PathBuf,
        /// Frames needed.
        frames: usize,
    },
    /// A recording that cannot be used, or not as the list says.
    #[error("{place}: {problem}")]
    Clip {
        /// File and line of the list, or the recording itself.
        place: String,
        /// What is wrong with it.
        problem: UnusableClip,
    },
    /// A recording that no list names and that cannot be imported; the error names it.
    #[error(transparent)]
    Recording(motion::MotionError),
    /// Motions that do not make a library.
    #[error(transparent)]
    Library(#[from] MotionLibraryError),
}

/// Why one recording cannot be used, or not as a list says.
#[derive(Debug, thiserror::Error)]
pub enum UnusableClip {
    /// A weight that is no share.
    #[error("the weight is {weight}: give one above zero, or leave the clip out")]
    Weight {
        /// The weight.
        weight: f32,
    },
    /// A file in a folder that cannot be read.
    #[error("cannot find '{}': the folder {} cannot be read: {error}", .file.display(), .folder.display())]
    Folder {
        /// The file as the list names it.
        file: PathBuf,
        /// The folder searched.
        folder: PathBuf,
        /// Why it cannot be read.
        error: std::io::Error,
    },
    /// A file that is not there.
    #[error("cannot find '{}': {} holds neither that file nor another recording whose name begins with '{start}'", .file.display(), .folder.display())]
    Missing {
        /// The file as the list names it.
        file: PathBuf,
        /// How its name had to begin.
        start: String,
        /// The folder searched.
        folder: PathBuf,
    },
    /// A file that is not there, where several have names that begin alike.
    #[error("'{}' could be any of {} in {}: write one of these names in full", .file.display(), .candidates.join(", "), .folder.display())]
    Ambiguous {
        /// The file as the list names it.
        file: PathBuf,
        /// The folder searched.
        folder: PathBuf,
        /// Names of the files that begin so.
        candidates: Vec<String>,
    },
    /// A span that is not within the recording.
    #[error(
        "the span from {start} to {end} s is not one within '{clip}', which lasts {seconds:.2} s without its T-poses"
    )]
    Span {
        /// Name of the recording.
        clip: String,
        /// First moment, s.
        start: f32,
        /// Last moment, s.
        end: f32,
        /// Length of the recording, s.
        seconds: f32,
    },
    /// A recording or a span that is too short.
    #[error(
        "'{clip}' has {frames} frames at 30 Hz, T-poses and what is outside its span left out, but {needed} are needed: use a longer one"
    )]
    Short {
        /// Name of the recording.
        clip: String,
        /// Its frames.
        frames: usize,
        /// Frames needed.
        needed: usize,
    },
    /// Feet that stand in the air or under the ground.
    #[error("the feet of '{clip}' stand {:.2} to {:.2} m above the ground (5th and 95th percentile of its frames), more than {most} m off: set `ground = true` on the clip, or give --ground for all clips, to bring them to the ground", .floor[0], .floor[1])]
    Feet {
        /// Name of the recording.
        clip: String,
        /// 5th and 95th percentile of the height at which the feet stand, m.
        floor: [f32; 2],
        /// Greatest height that is allowed, m.
        most: f32,
    },
    /// A BVH file that cannot be imported.
    #[error(transparent)]
    Motion(#[from] motion::MotionError),
    /// A file that is not one of DeepMimic's.
    #[error(transparent)]
    DeepMimic(#[from] DeepMimicError),
    /// A skeleton or a model that lacks something.
    #[error("'{clip}' cannot be put into the body: {error}")]
    Retarget {
        /// Name of the recording.
        clip: String,
        /// What the recording, its skeleton or the model lacks.
        error: RetargetError,
    },
    /// A model that has no two like sides.
    #[error(transparent)]
    Mirror(#[from] MirrorError),
}
