//! The error that there is no graphics adapter.

/// No adapter of the requested kind.
#[derive(Debug, thiserror::Error)]
#[error("no {wanted} found: {remedy}{instead}")]
pub struct NoAdapter {
    pub(super) wanted: &'static str,
    /// What would bring one.
    pub(super) remedy: &'static str,
    /// What else there is to do.
    pub(super) instead: &'static str,
}

/// Networks and environments need no adapter.
pub(super) const INSTEAD: &str = ", or use `--device cpu`";
