//! Printing to readers that may go away: a closed pipe ends nothing, a full disk is an error at the end.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether somebody else says it all.
static SILENT: AtomicBool = AtomicBool::new(false);
/// Why something could not be printed, if it matters.
static FAILURE: Mutex<Option<io::Error>> = Mutex::new(None);

/// A line on stdout.
macro_rules! say {
    ($($words:tt)*) => { $crate::cli::say::print(format_args!("{}\n", format_args!($($words)*))) };
}

/// Text on stdout, whose lines it ends itself.
macro_rules! show {
    ($($words:tt)*) => { $crate::cli::say::print(format_args!($($words)*)) };
}

/// A line on stderr. Nothing depends on whether anybody reads it.
macro_rules! tell {
    ($($words:tt)*) => { $crate::cli::say::report(&format!($($words)*)) };
}

pub(crate) use {say, show, tell};

/// Lets this process say nothing from now on but what it complains about: another one speaks for both.
#[cfg(feature = "mpi")]
pub fn silence() {
    SILENT.store(true, Ordering::Relaxed);
}

/// Prints to stdout.
pub fn print(text: Arguments) {
    if SILENT.load(Ordering::Relaxed) {
        return;
    }
    let mut stdout = io::stdout().lock();
    let printed = stdout.write_fmt(text).and_then(|()| stdout.flush());
    match printed {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            let mut failure = FAILURE.lock().unwrap_or_else(|held| held.into_inner());
            failure.get_or_insert(error);
        }
        // Who has read enough wants no more, and no complaint.
        _ => {}
    }
}

/// Characters of the longest word of a message: a path fits, a damaged file's line does not.
const LONGEST: usize = 400;
/// Characters that are left of a longer one.
const LEFT: usize = 60;

/// Prints a message to stderr.
pub fn report(message: &str) {
    if !SILENT.load(Ordering::Relaxed) {
        complain(message);
    }
}

/// Prints a message to stderr, whoever speaks.
pub fn complain(message: &str) {
    let _ = writeln!(io::stderr(), "{}", printable(message));
}

/// A message as a terminal may show it: what files hold is quoted in messages, and may be anything.
fn printable(message: &str) -> String {
    let words = message.split_inclusive(char::is_whitespace).map(|word| {
        let mut word = word.to_string();
        if word.chars().count() > LONGEST {
            word = word.chars().take(LEFT).chain("...".chars()).collect();
        }
        word
    });
    let shown = words.collect::<String>();
    let shown = shown.chars().flat_map(|character| {
        let plain = !character.is_control() || character == '\n' || character == '\t';
        let escaped = (!plain).then(|| character.escape_unicode());
        plain
            .then_some(character)
            .into_iter()
            .chain(escaped.into_iter().flatten())
    });
    shown.collect()
}

/// Whether all that was said could be printed, as far as anybody wanted it.
///
/// # Errors
/// The first that could not.
pub fn printed() -> anyhow::Result<()> {
    let mut failure = FAILURE.lock().unwrap_or_else(|held| held.into_inner());
    match failure.take() {
        None => Ok(()),
        Some(error) => Err(anyhow::anyhow!("cannot write to standard output: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_fit_for_a_terminal() {
        assert_eq!(printable("a \u{1b}[31mb\nc"), "a \\u{1b}[31mb\nc");
        let long = format!("key {} is", "x".repeat(3000));
        assert!(printable(&long).len() < 100 && printable("a/b c").len() == 5);
    }
}
