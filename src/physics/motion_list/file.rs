//! Motion lists as TOML files.

use super::error::{MotionListError, Result, UnusableClip};
use super::folder::find;
use super::listed::{ListedClip, MotionList};
use crate::input_file;
use serde::Deserialize;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    #[serde(default)]
    clip: Vec<Row>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    file: Spanned<PathBuf>,
    start: Option<f32>,
    end: Option<f32>,
    #[serde(default = "one")]
    weight: f32,
    mirror: Option<bool>,
    #[serde(default)]
    kind: String,
    ground: Option<bool>,
}

fn one() -> f32 {
    1.0
}

/// Bytes of the longest list.
const MAX_BYTES: u64 = 1 << 24;

/// Reads a list whose files are in `folder`.
pub fn read(path: &Path, folder: &Path) -> Result<MotionList> {
    let text = input_file::text(path, MAX_BYTES).map_err(|error| MotionListError::Read {
        path: path.to_path_buf(),
        error,
    })?;
    let table: Table = toml::from_str(&text).map_err(|error| MotionListError::Toml {
        path: path.to_path_buf(),
        line: line(&text, error.span().unwrap_or_default()),
        problem: error.message().replace('\n', ", "),
    })?;
    if table.clip.is_empty() {
        return Err(MotionListError::Empty {
            path: path.to_path_buf(),
        });
    }
    let clips = table.clip.into_iter();
    let clips = clips.map(|row| {
        let line = line(&text, row.file.span());
        row.checked(line, folder)
            .map_err(|problem| MotionListError::Clip {
                place: format!("{}, line {line}", path.display()),
                problem,
            })
    });
    Ok(MotionList {
        clips: clips.collect::<Result<_>>()?,
        path: path.to_path_buf(),
        skip_short: false,
    })
}

/// The line, from 1, in which a part of a text begins.
fn line(text: &str, part: Range<usize>) -> usize {
    text[..part.start].matches('\n').count() + 1
}

impl Row {
    fn checked(self, line: usize, folder: &Path) -> std::result::Result<ListedClip, UnusableClip> {
        if !(self.weight > 0.0 && self.weight.is_finite()) {
            return Err(UnusableClip::Weight {
                weight: self.weight,
            });
        }
        Ok(ListedClip {
            file: find(folder, self.file.get_ref())?,
            line: Some(line),
            span: [self.start, self.end],
            weight: self.weight,
            mirror: self.mirror,
            kind: self.kind,
            ground: self.ground,
        })
    }
}
