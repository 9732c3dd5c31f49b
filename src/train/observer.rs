//! Somebody who follows a training.

use super::config::Config;
use super::metrics::UpdateMetrics;
use super::state::RecentMeans;
use crate::env::EnvBatch;
use crate::nn::Policy;
use anyhow::Result;

/// What a training tells while it runs. `()` does not listen.
pub trait Observer {
    /// Another training of several begins: its name, and its choices.
    fn begins(&mut self, _name: &str, _config: &Config) {}

    /// The environments are open, and nothing has been played.
    ///
    /// # Errors
    /// They cannot be looked at: the training ends.
    fn opened(&mut self, _envs: &mut EnvBatch) -> Result<()> {
        Ok(())
    }

    /// Something happened that the user should know of and that stops nothing.
    fn noted(&mut self, _note: &str) {}

    /// Films the fixed episodes of a policy, for somebody who looks on from elsewhere: a GIF file, if there is
    /// something to film with.
    ///
    /// # Errors
    /// The film cannot be made; the training goes on without films.
    fn film(&mut self, _policy: &Policy) -> Result<Option<Vec<u8>>> {
        Ok(None)
    }

    /// An update is over; `recent` are means over the latest episodes.
    fn updated(&mut self, _row: &UpdateMetrics, _recent: RecentMeans) {}
}

impl Observer for () {}
