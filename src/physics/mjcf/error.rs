//! What can go wrong between a file and a model.

use std::path::PathBuf;

pub type Result<T> = std::result::Result<T, MjcfError>;

/// Each message says what is wrong, where, and what to do about it.
#[derive(Debug, thiserror::Error)]
pub enum MjcfError {
    #[error("cannot read {}: {error}; check that it exists and may be read", .path.display())]
    Read {
        path: PathBuf,
        error: std::io::Error,
    },

    #[error("{} holds more than {limit} bytes, too many for a model; leave meshes and the like out of it", .path.display())]
    TooLarge { path: PathBuf, limit: u64 },

    /// `problem` names the element, and ends with what to do where that is not plain.
    #[error("{}, line {line}: {problem}", .path.display())]
    Mjcf {
        path: PathBuf,
        line: u32,
        problem: String,
    },
}
