//! What the trainer remembers from update to update; part of a checkpoint.

use crate::container::{Section, SectionError};
use crate::env::Stats;

/// Means over the latest episodes are over at least so many.
const RECENT: f64 = 500.0;

/// Sums over the episodes that ended in an update.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
struct EpisodeSums {
    episodes: f64,
    successes: f64,
    steps: f64,
    returns: f64,
}

/// How good the latest episodes were: a higher level, then more success, then shorter episodes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, bytemuck::Pod, bytemuck::Zeroable)]
struct Score {
    levels_passed: f64,
    /// Whole percents, so that noise in the success does not hide that episodes get shorter.
    success_percent: f64,
    negative_length: f64,
}

/// Means over the latest episodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RecentMeans {
    /// Fraction of successes.
    pub success: f64,
    /// Steps.
    pub length: f64,
    /// Sum of rewards.
    pub episode_return: f64,
}

/// What the trainer remembers from update to update.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrainerState {
    /// One a recent update.
    recent: Vec<EpisodeSums>,
    /// The score of the best policy so far.
    best: Option<Score>,
}

impl TrainerState {
    /// Takes an update's episodes in.
    pub fn remember(&mut self, stats: &Stats) {
        self.recent.push(EpisodeSums {
            episodes: stats.sum("episodes"),
            successes: stats.sum("successes"),
            steps: stats.sum("steps"),
            returns: stats.sum("returns"),
        });
        let episodes =
            |recent: &[EpisodeSums]| recent.iter().map(|sums| sums.episodes).sum::<f64>();
        while self.recent.len() > 1 && episodes(&self.recent[1..]) >= RECENT {
            self.recent.remove(0);
        }
    }

    /// Means over the latest episodes. None before the first ended.
    pub fn means(&self) -> Option<RecentMeans> {
        let sum = |of: fn(&EpisodeSums) -> f64| self.recent.iter().map(of).sum::<f64>();
        let episodes = sum(|sums| sums.episodes);
        (episodes > 0.0).then(|| RecentMeans {
            success: sum(|sums| sums.successes) / episodes,
            length: sum(|sums| sums.steps) / episodes,
            episode_return: sum(|sums| sums.returns) / episodes,
        })
    }

    /// Whether the latest episodes are the best so far.
    pub fn improved(&mut self, levels_passed: u32) -> bool {
        let Some(means) = self.means() else {
            return false;
        };
        let score = Score {
            levels_passed: levels_passed.into(),
            success_percent: (means.success * 100.0).floor(),
            negative_length: -means.length,
        };
        let better = self.best.is_none_or(|best| score > best);
        if better {
            self.best = Some(score);
        }
        better
    }

    /// Saves all of it.
    pub fn save(&self, to: &mut Section) {
        to.put("recent", self.recent.len());
        to.put_array("recent", &self.recent);
        to.put("best", self.best.is_some());
        to.put_array("best", self.best.as_slice());
    }

    /// Reads what [`TrainerState::save`] saved.
    ///
    /// # Errors
    /// It is not that.
    pub fn load(from: &mut Section) -> Result<Self, SectionError> {
        let (recent, best) = (from.get("recent")?, from.get::<bool>("best")?);
        Ok(TrainerState {
            recent: from.take_array("recent", recent)?,
            best: from.take_array("best", best.into())?.pop(),
        })
    }
}
