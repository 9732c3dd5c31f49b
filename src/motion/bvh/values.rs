//! The second half of a BVH file: how many frames, how fast, and their numbers.

use super::fault::{problem, shorten};
use super::number::number;
use super::text::is_comment;
use crate::motion::error::{MotionError, MotionResult};
use std::path::Path;

/// Rates (Hz) outside of this are a mistake in the file: the import could neither thin them
/// out nor fill them in sensibly.
const RATES: std::ops::RangeInclusive<f32> = 4.9..=10_100.0;

/// Every number of a file, `[frame][channel]`.
pub struct Values {
    pub frames: usize,
    /// Frames a second.
    pub rate: f32,
    pub numbers: Vec<f32>,
}

/// Reads what follows the word MOTION, which stands in line `line` (from 1). `width` is how many
/// numbers make a frame. They may be wrapped over lines at will. Memory grows with the numbers
/// that are there, never with the number of frames that the file claims.
pub fn parse(text: &str, path: &Path, line: usize, width: usize) -> MotionResult<Values> {
    let mut header = Header {
        rest: text,
        path,
        line,
    };
    let frames = header.value("Frames")?;
    let frames = count(path, header.line, frames)?;
    let time = header.value("Frame Time")?;
    let rate = rate(path, header.line, time)?;

    let mut numbers = Vec::new();
    let mut last = header.line;
    for (line, text) in (header.line..).zip(header.rest.lines()) {
        let words = text.split_ascii_whitespace();
        for word in words.take_while(|word| !is_comment(word)) {
            let is_last =
                || header.rest.as_bytes().as_ptr_range().end == word.as_bytes().as_ptr_range().end;
            numbers.push(number(path, line, word).map_err(|error| match is_last() {
                true => truncated(path, line, word),
                false => error,
            })?);
            last = line;
        }
    }
    check_size(path, last, &numbers, frames, width)?;
    Ok(Values {
        frames,
        rate,
        numbers,
    })
}

/// The two lines between MOTION and the numbers, however they are broken.
struct Header<'a> {
    /// What has not been read yet.
    rest: &'a str,
    path: &'a Path,
    /// Line (from 1) of what was read last.
    line: usize,
}

impl<'a> Header<'a> {
    /// Takes a key, a colon if there is one, and the word that follows.
    fn value(&mut self, key: &str) -> MotionResult<&'a str> {
        let before = self.line;
        self.skip_blank();
        if self.rest.is_empty() {
            let what = format!("the file ends before '{key}:'; it is truncated");
            return Err(problem(self.path, before, what));
        }
        let Some(rest) = after_key(self.rest, key) else {
            let found = self.rest.lines().next().unwrap_or_default();
            let what = format!("expected '{key}:', found '{}'", shorten(found.trim()));
            return Err(problem(self.path, self.line, what));
        };
        self.rest = rest;
        self.skip_blank();
        let end = self.rest.find(char::is_whitespace);
        let (word, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        self.rest = rest;
        Ok(word)
    }

    fn skip_blank(&mut self) {
        loop {
            let rest = self.rest.trim_start();
            let skipped = &self.rest[..self.rest.len() - rest.len()];
            self.line += skipped.matches('\n').count();
            self.rest = rest;
            if !is_comment(rest) {
                return;
            }
            self.rest = rest.find('\n').map_or("", |end| &rest[end..]);
        }
    }
}

/// What stands behind a key and its colon. The case does not matter, nor do blanks within.
fn after_key<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let mut rest = text;
    for letter in key.chars() {
        rest = match letter {
            ' ' => rest.trim_start(),
            _ => rest.strip_prefix(|c: char| c.eq_ignore_ascii_case(&letter))?,
        };
    }
    let rest = rest.trim_start();
    Some(rest.strip_prefix(':').unwrap_or(rest))
}

fn truncated(path: &Path, line: usize, word: &str) -> MotionError {
    let word = shorten(word);
    problem(
        path,
        line,
        format!("the file ends with '{word}', which is no number; it is truncated"),
    )
}

fn count(path: &Path, line: usize, text: &str) -> MotionResult<usize> {
    // Some programs count in floating point.
    let whole = text
        .split_once('.')
        .filter(|(_, part)| part.bytes().all(|b| b == b'0'));
    match whole.map_or(text, |(whole, _)| whole).parse() {
        Ok(0) => Err(problem(path, line, "zero frames: there is no motion in it")),
        Ok(frames) => Ok(frames),
        Err(_) => Err(problem(
            path,
            line,
            format!("expected a number of frames, found '{}'", shorten(text)),
        )),
    }
}

fn rate(path: &Path, line: usize, text: &str) -> MotionResult<f32> {
    let time = number(path, line, text)?;
    let rate = 1.0 / time;
    if time > 0.0 && RATES.contains(&rate) {
        return Ok(rate);
    }
    Err(problem(
        path,
        line,
        format!(
            "a frame time of {text} s; it must lie between 0.0001 and 0.2 s, as 0.0333333 does"
        ),
    ))
}

fn check_size(
    path: &Path,
    line: usize,
    numbers: &[f32],
    frames: usize,
    width: usize,
) -> MotionResult<()> {
    let expected = frames as u128 * width as u128;
    let found = numbers.len();
    if expected == found as u128 {
        return Ok(());
    }
    let verdict = match expected > found as u128 {
        true => "the file is truncated, or its Frames line is wrong",
        false => "the Frames line or the CHANNELS are wrong",
    };
    Err(problem(
        path,
        line,
        format!(
            "expected {expected} values ({frames} frames of {width}), found {found} ({} whole frames and {} values); {verdict}",
            found / width.max(1),
            found % width.max(1),
        ),
    ))
}
