//! What can go wrong between a file and a model.

use std::fmt;
use std::path::PathBuf;

/// A result of reading MJCF.
pub type Result<T> = std::result::Result<T, MjcfError>;

/// A result of reading a part of it.
pub type Checked<T> = std::result::Result<T, Fault>;

/// Something wrong at a byte of the text.
pub struct Fault {
    pub at: usize,
    pub problem: String,
}

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

    /// A file or text of more bytes than a model may have, with all that it includes.
    #[error("{} holds more than {limit} bytes, too many for a model; leave meshes and the like out of it", .path.display())]
    TooLarge {
        /// File to be read.
        path: PathBuf,
        /// Most bytes allowed, [`MAX_BYTES`](super::MAX_BYTES).
        limit: u64,
    },

    /// All that is wrong in a file and those that it includes, in their order: a line each.
    #[error("{}", lines(.0))]
    Mjcf(Vec<MjcfProblem>),
}

/// Something wrong in a file. `problem` names the element, and ends with what to do where that is not plain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MjcfProblem {
    /// File that the text is from.
    pub path: PathBuf,
    /// Line of the text, the first being 1.
    pub line: u32,
    /// What is wrong on that line.
    pub problem: String,
}

impl fmt::Display for MjcfProblem {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let (path, line) = (self.path.display(), self.line);
        write!(out, "{path}, line {line}: {}", self.problem)
    }
}

/// A file with one thing wrong in it.
pub fn problem(path: PathBuf, line: u32, problem: String) -> MjcfError {
    MjcfError::Mjcf(vec![MjcfProblem {
        path,
        line,
        problem,
    }])
}

fn lines(problems: &[MjcfProblem]) -> String {
    let lines = problems.iter().map(MjcfProblem::to_string);
    lines.collect::<Vec<_>>().join("\n")
}
