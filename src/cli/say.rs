//! Printing to readers that may go away: a closed pipe ends nothing, a full disk is an error at the end.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::sync::Mutex;

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
    ($($words:tt)*) => {{
        use std::io::Write;
        let _ = writeln!(std::io::stderr(), $($words)*);
    }};
}

pub(crate) use {say, show, tell};

/// Prints to stdout.
pub fn print(text: Arguments) {
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
