//! Files that cannot be used: named all at once, or left out.

use crate::motion::error::{MotionError, MotionResult};
use crate::motion::findings::listed;
use std::collections::BTreeMap;
use std::path::Path;

/// Problems that an error or a note lists before it counts the rest.
const MOST_PROBLEMS: usize = 20;

/// Files that cannot be used, and why.
#[derive(Default)]
pub struct BadFiles(BTreeMap<usize, MotionError>);

impl BadFiles {
    /// Takes the errors out, each with the number of its file.
    pub fn sort_out<T>(
        &mut self,
        results: impl Iterator<Item = (usize, MotionResult<T>)>,
    ) -> Vec<(usize, T)> {
        let mut good = Vec::new();
        for (file, result) in results {
            match result {
                Ok(value) => good.push((file, value)),
                Err(error) => {
                    self.0.insert(file, error);
                }
            }
        }
        good
    }

    /// A note that they are left out if they may be, else an error.
    pub fn settle(
        self,
        path: &Path,
        files: usize,
        leave_out: bool,
    ) -> MotionResult<Option<String>> {
        match (self.0.is_empty(), leave_out) {
            (true, _) => Ok(None),
            (false, false) => Err(self.into_error(path, files)),
            (false, true) => Ok(Some(format!(
                "{} of {files} files left out, since they cannot be used:\n  {}",
                self.0.len(),
                self.problems().join("\n  ")
            ))),
        }
    }

    /// One error for all of them: that of a single file, or of a roles file, itself, since no other file is
    /// better.
    pub fn into_error(mut self, path: &Path, files: usize) -> MotionError {
        let is_sole =
            |error: &MotionError| files == 1 || matches!(error, MotionError::RolesFile { .. });
        let sole = self.0.iter().find(|(_, error)| is_sole(error));
        let sole = sole.map(|(&file, _)| file);
        if let Some(error) = sole.and_then(|file| self.0.remove(&file)) {
            return error;
        }
        MotionError::BadFiles {
            path: path.to_path_buf(),
            bad: self.0.len(),
            total: files,
            problems: self.problems(),
        }
    }

    /// What is wrong, in the order of the files; one problem for all that have the same.
    fn problems(&self) -> Vec<String> {
        let mut problems: Vec<(String, Vec<String>)> = Vec::new();
        for error in self.0.values() {
            let (file, problem) = match error {
                MotionError::In { path, error } => (path.display().to_string(), error.to_string()),
                error => (String::new(), error.to_string()),
            };
            match problems.iter_mut().find(|known| known.0 == problem) {
                Some((_, files)) => files.push(file),
                None => problems.push((problem, vec![file])),
            }
        }
        let problems = problems.into_iter();
        let all: Vec<String> = problems
            .map(|(problem, files)| match files[0].is_empty() {
                true => problem,
                false => format!("{}: {problem}", listed(&files)),
            })
            .collect();
        let more = all.len().saturating_sub(MOST_PROBLEMS);
        let mut shown: Vec<String> = all.into_iter().take(MOST_PROBLEMS).collect();
        if more > 0 {
            shown.push(format!("and {more} more"));
        }
        shown
    }
}
