//! What can go wrong between a file and a model.

use std::path::PathBuf;

/// A result of reading MJCF.
pub type Result<T> = std::result::Result<T, MjcfError>;

/// Each message says what is wrong, where, and what to do about it.
#[derive(Debug, thiserror::Error)]
pub enum MjcfError {
    /// A file that cannot be opened or read.
    #[error("cannot read {}: {error}; check that it exists and may be read", .path.display())]
    Read {
        /// File to be read.
        path: PathBuf,
        /// Cause, from the operating system.
        error: std::io::Error,
    },

    /// A file or text of more bytes than a model may have.
    #[error("{} holds more than {limit} bytes, too many for a model; leave meshes and the like out of it", .path.display())]
    TooLarge {
        /// File to be read.
        path: PathBuf,
        /// Most bytes allowed, [`MAX_BYTES`](super::MAX_BYTES).
        limit: u64,
    },

    /// `problem` names the element, and ends with what to do where that is not plain.
    #[error("{}, line {line}: {problem}", .path.display())]
    Mjcf {
        /// File that the text is from.
        path: PathBuf,
        /// Line of the text, the first being 1.
        line: u32,
        /// What is wrong on that line.
        problem: String,
    },
}
