//! Somebody who follows a training.

use super::config::Config;
use super::metrics::UpdateMetrics;
use super::state::RecentMeans;
use crate::env::EnvBatch;
use anyhow::Result;

/// What a training tells while it runs. `()` does not listen.
pub trait Observer {
    /// Another training with these choices begins, of several.
    fn begins(&mut self, _config: &Config) {}

    /// The environments are open, and nothing has been played.
    ///
    /// # Errors
    /// They cannot be looked at: the training ends.
    fn opened(&mut self, _envs: &mut EnvBatch) -> Result<()> {
        Ok(())
    }

    /// Something happened that the user should know of and that stops nothing.
    fn noted(&mut self, _note: &str) {}

    /// An update is over; `recent` are means over the latest episodes.
    fn updated(&mut self, _row: &UpdateMetrics, _recent: RecentMeans) {}
}

impl Observer for () {}
