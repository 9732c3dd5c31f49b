//! The command line. Exit codes: 0 done, 1 failed, 2 asked for wrongly.

// A print panics when its reader has gone away: see `cli::say`.
#![warn(clippy::print_stdout, clippy::print_stderr)]

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    quiet_mesa();
    match cli::run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            cli::say::tell!("error: {error:#}");
            ExitCode::from(cli::exit_code(&error))
        }
    }
}

/// Mesa's device-select layer for Vulkan asks the desktop which GPU it prefers, and complains on
/// stderr where there is no desktop. Nothing here depends on its answer.
fn quiet_mesa() {
    if cfg!(target_os = "linux") && std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: this is the program's first act; no other thread is there to read the environment.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}
