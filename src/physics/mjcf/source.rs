//! The text of a model, with that of the files it includes in its place; where each part of it is from, and
//! what is wrong with it.

use super::error::{Fault, MjcfError, MjcfProblem, Result, problem};
use crate::input_file;
use roxmltree::{Document, Node};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Size of the largest file that is read, and of a model with all that it includes, bytes: 1 MiB.
pub const MAX_BYTES: u64 = 1 << 20;
/// Problems that are told at most: more of them are of no use to anybody.
const MOST_PROBLEMS: usize = 50;
/// Files that may be included.
const MOST_FILES: usize = 100;

pub struct MjcfSource {
    pub text: String,
    /// In the order of the text.
    parts: Vec<Part>,
    /// The model's, then those that are included.
    files: Vec<PathBuf>,
    /// By their place: of several in one place the first.
    problems: RefCell<BTreeMap<usize, String>>,
}

/// A piece of a file that stands in the text unchanged.
struct Part {
    start: usize,
    file: usize,
    /// Line of the file at which the piece begins.
    line: u32,
}

impl MjcfSource {
    /// # Errors
    /// Text that is no XML, or an included file that cannot be read.
    pub fn new(text: &str, file: &Path) -> Result<MjcfSource> {
        let mut source = MjcfSource {
            text: String::new(),
            parts: Vec::new(),
            files: Vec::new(),
            problems: RefCell::default(),
        };
        source.append(text, file.to_path_buf(), |_| 0..text.len())?;
        Ok(source)
    }

    /// Appends what `range` takes of a file, and what that includes.
    fn append(
        &mut self,
        text: &str,
        path: PathBuf,
        range: impl Fn(Node) -> Range<usize>,
    ) -> Result<()> {
        let file = self.files.len();
        self.files.push(path.clone());
        let document = xml(text, &path)?;
        let range = range(document.root_element());
        let mut from = range.start;
        let mut includes = document.descendants();
        while let Some(include) = includes.find(|node| node.has_tag_name("include")) {
            // What is in an include itself goes with it.
            if include.range().start >= from {
                self.copy(text, file, from..include.range().start)?;
                from = include.range().end;
                self.include(&include, &path)?;
            }
        }
        self.copy(text, file, from..range.end)
    }

    fn copy(&mut self, text: &str, file: usize, range: Range<usize>) -> Result<()> {
        self.parts.push(Part {
            start: self.text.len(),
            file,
            line: 1 + newlines(&text.as_bytes()[..range.start]),
        });
        self.text.push_str(&text[range]);
        match self.text.len() as u64 <= MAX_BYTES {
            true => Ok(()),
            false => Err(MjcfError::TooLarge {
                path: self.files[file].clone(),
                limit: MAX_BYTES,
            }),
        }
    }

    /// Appends what stands in the root of an included file.
    fn include(&mut self, element: &Node, by: &Path) -> Result<()> {
        let wrong = |what: String| {
            let line = element.document().text_pos_at(element.range().start).row;
            problem(by.to_path_buf(), line, format!("<include> {what}"))
        };
        let Some(name) = element.attribute("file") else {
            return Err(wrong("needs the attribute file".into()));
        };
        // As MuJoCo has it: from the folder of the model itself.
        let path = self.files[0].parent().unwrap_or(Path::new("")).join(name);
        if self.files.contains(&path) {
            let what = format!("has file=\"{name}\": it is there already; include it once");
            return Err(wrong(what));
        }
        if self.files.len() > MOST_FILES {
            let what = format!("is one file too many: there may be {MOST_FILES}");
            return Err(wrong(what));
        }
        let text = match read_text(&path) {
            Err(MjcfError::Read { error, .. }) => {
                let path = path.display();
                let what = format!("has file=\"{name}\": cannot read {path}: {error}");
                return Err(wrong(what));
            }
            text => text?,
        };
        self.append(&text, path, |root| {
            let (first, last) = (root.first_child(), root.last_child());
            first.map_or(0, |node| node.range().start)..last.map_or(0, |node| node.range().end)
        })
    }

    /// Takes note of what is wrong.
    pub fn report(&self, fault: Fault) {
        let mut problems = self.problems.borrow_mut();
        if problems.len() < MOST_PROBLEMS {
            problems.entry(fault.at).or_insert(fault.problem);
        }
    }

    /// Whether nothing is wrong.
    ///
    /// # Errors
    /// All that is.
    pub fn check(&self) -> Result<()> {
        let problems = self.problems.borrow();
        let told = problems.iter().map(|(&at, problem)| {
            let part = self.parts.partition_point(|part| part.start <= at) - 1;
            let part = &self.parts[part];
            MjcfProblem {
                path: self.files[part.file].clone(),
                line: part.line + newlines(&self.text.as_bytes()[part.start..at]),
                problem: problem.clone(),
            }
        });
        match problems.is_empty() {
            true => Ok(()),
            false => Err(MjcfError::Mjcf(told.collect())),
        }
    }
}

/// The text of a file.
pub fn read_text(path: &Path) -> Result<String> {
    let failed = |error| MjcfError::Read {
        path: path.to_path_buf(),
        error,
    };
    let mut bytes = Vec::new();
    let file = input_file::open(path, u64::MAX).map_err(failed)?;
    // One more than allowed: enough to be refused.
    let mut file = file.take(MAX_BYTES + 1);
    file.read_to_end(&mut bytes).map_err(failed)?;
    refuse_large(bytes.len(), path)?;
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + newlines(good);
        let what = "bytes that are not UTF-8; save the file as UTF-8";
        problem(path.to_path_buf(), line, what.to_string())
    })
}

pub fn refuse_large(bytes: usize, path: &Path) -> Result<()> {
    match bytes as u64 <= MAX_BYTES {
        true => Ok(()),
        false => Err(MjcfError::TooLarge {
            path: path.to_path_buf(),
            limit: MAX_BYTES,
        }),
    }
}

/// The document of a file's text.
///
/// # Errors
/// It is no valid XML.
pub fn xml<'a>(text: &'a str, path: &Path) -> Result<Document<'a>> {
    Document::parse(text).map_err(|error| {
        let what = format!("this is no valid XML: {error}");
        problem(path.to_path_buf(), error.pos().row, what)
    })
}

fn newlines(text: &[u8]) -> u32 {
    text.iter().filter(|byte| **byte == b'\n').count() as u32
}
