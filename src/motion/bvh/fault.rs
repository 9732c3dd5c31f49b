//! Errors of a file, with the line.

use crate::motion::error::MotionError;
use std::path::Path;

/// The error of this file at this line (from 1).
pub fn problem(path: &Path, line: usize, problem: impl Into<String>) -> MotionError {
    MotionError::Bvh {
        path: path.to_path_buf(),
        line,
        problem: problem.into(),
    }
}

/// At most 40 characters of a word that may be a whole binary file, with nothing unprintable.
pub fn shorten(word: &str) -> String {
    let mut short: String = word.chars().take(40).flat_map(char::escape_debug).collect();
    if word.chars().nth(40).is_some() {
        short.push_str("...");
    }
    short
}
