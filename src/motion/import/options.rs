//! Choices of an import.

use crate::motion::up::UpAxis;
use std::path::PathBuf;

/// Choices of an import.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// Metres per file unit, instead of what the manifest says or the skeleton shows.
    pub unit_m: Option<f32>,
    /// The axis that is up in the files, instead of what the motion shows.
    pub up: Option<UpAxis>,
    /// A roles file ([`Roles::read`](crate::motion::roles::Roles::read)), for skeletons whose names and form say too little.
    pub roles: Option<PathBuf>,
    /// Cut recordings where they jump and keep the longest piece of each, instead of refusing them.
    pub trim: bool,
    /// Read the files of sub-folders too.
    pub recursive: bool,
    /// Leave out files that cannot be used, with a note, instead of refusing all.
    pub skip_bad: bool,
    /// Add the left/right mirrored copy of each clip, after all the clips themselves.
    pub mirror: bool,
}
