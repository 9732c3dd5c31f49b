//! Mistakes of usage.

#[cfg(feature = "report")]
use anyhow::Result;
#[cfg(feature = "report")]
use std::path::Path;

/// The user requested something that cannot be meant.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Usage(pub String);

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
