//! Mistakes of usage.

#[cfg(feature = "report")]
use anyhow::Result;
use footwork::motion::error::MotionError;
use footwork::train::config::ConfigError;
use footwork::train::task::Unsupported;
#[cfg(feature = "report")]
use std::path::Path;

/// The user requested something that cannot be meant.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Usage(pub String);

/// 2 for mistakes of usage, 1 for everything else.
pub fn exit_code(error: &anyhow::Error) -> u8 {
    let roles = matches!(error.downcast_ref(), Some(MotionError::RolesFile { .. }));
    let usage = error.is::<Usage>() || error.is::<ConfigError>() || error.is::<Unsupported>();
    match usage || roles {
        true => 2,
        false => 1,
    }
}

/// Refuses impossible files before minutes of work are lost.
#[cfg(feature = "report")]
pub fn writable(file: &Path) -> Result<()> {
    let folder = match file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let why = match (file.is_dir(), folder.is_dir()) {
        (true, _) => "it is a folder; give the name of a file in it",
        (_, false) => "its folder must exist",
        _ => return Ok(()),
    };
    Err(Usage(format!("{} cannot be written: {why}", file.display())).into())
}
