//! One number of a BVH file, and why a word is none.

use super::fault::{problem, shorten};
use crate::motion::error::{MotionError, MotionResult};
use std::path::Path;

/// A finite number of sane size. The bound keeps every later product of lengths finite.
pub fn number(path: &Path, line: usize, word: &str) -> MotionResult<f32> {
    match word.parse::<f32>() {
        Ok(value) if value.abs() < 1e9 => Ok(value),
        Ok(_) => Err(unusable(path, line, word)),
        Err(_) if is_nan(word) => Err(unusable(path, line, word)),
        Err(_) => Err(problem(
            path,
            line,
            format!(
                "expected a number, found '{}'{}",
                shorten(word),
                advice(word)
            ),
        )),
    }
}

fn unusable(path: &Path, line: usize, word: &str) -> MotionError {
    let word = shorten(word);
    let what = format!(
        "'{word}' is no usable number: NaN, infinite or beyond 1e9; export the file again without it"
    );
    problem(path, line, what)
}

/// How C's printf spells what is not a number: `-1.#IND00`, `1.#QNAN`, `-nan(ind)`.
fn is_nan(word: &str) -> bool {
    let word = word.to_ascii_lowercase();
    ["#ind", "#qnan", "#snan", "#inf", "nan("]
        .iter()
        .any(|nan| word.contains(nan))
}

/// What to do about a word that was meant as a number.
fn advice(word: &str) -> &'static str {
    let digits = word.contains(|c: char| c.is_ascii_digit())
        && word
            .chars()
            .all(|c| c.is_ascii_digit() || matches!(c, '.' | ',' | '-' | '+' | 'e' | 'E'));
    match digits {
        true if word.contains(',') => "; write decimal points, not commas",
        true => "; are these two numbers without a space between them?",
        false => "",
    }
}
