//! What can go wrong with a picture.

/// A picture could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The drawing itself failed, before any file was touched.
    #[error("cannot draw the picture: {0}")]
    Draw(String),
    /// The finished picture could not be written; the message names the file.
    #[error(transparent)]
    Write(#[from] std::io::Error),
}
