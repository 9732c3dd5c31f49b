//! The second half of a BVH file: how many frames, how fast, and their numbers.

use super::hierarchy::{number, problem, shorten};
use crate::motion::error::MotionResult;
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

/// Reads what follows line `after` (from 1), the one that says MOTION. `width` is how many
/// numbers make a frame. They may be wrapped over lines at will. Memory grows with the numbers
/// that are there, never with the number of frames that the file claims.
pub fn parse(text: &str, path: &Path, after: usize, width: usize) -> MotionResult<Values> {
    let mut lines = (1..).zip(text.lines()).skip(after);
    let mut header = |key: &str| {
        let (line, text) = lines
            .by_ref()
            .find(|(_, text)| !text.trim().is_empty())
            .ok_or_else(|| {
                problem(
                    path,
                    after,
                    format!("the file ends before '{key}:'; it is truncated"),
                )
            })?;
        match text.split_once(':') {
            Some((found, value)) if found.trim().eq_ignore_ascii_case(key) => {
                Ok((line, value.trim()))
            }
            _ => Err(problem(
                path,
                line,
                format!("expected '{key}:', found '{}'", shorten(text.trim())),
            )),
        }
    };
    let (frames_line, frames) = header("Frames")?;
    let (time_line, time) = header("Frame Time")?;
    let frames = count(path, frames_line, frames)?;
    let rate = rate(path, time_line, time)?;

    let mut numbers = Vec::new();
    let mut last = time_line;
    for (line, text) in lines {
        for word in text.split_ascii_whitespace() {
            numbers.push(number(path, line, word)?);
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

fn count(path: &Path, line: usize, text: &str) -> MotionResult<usize> {
    match text.parse() {
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
