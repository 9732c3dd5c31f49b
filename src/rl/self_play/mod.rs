//! Self-play: a policy learns against what it was before.
//!
//! [`SelfPlay`] holds what may be chosen. A [`Pool`] keeps [opponents](Opponent) and how the learner fares against
//! each; [`SelfPlayEnv`] makes environments of two agents into environments of one, whose other agent is played by
//! one of them, on their device; and a [`SelfPlayLearner`] is any learner whose policy joins the pool when it wins.

mod batch_opponents;
mod bouts;
mod frozen_policies;
mod learner;
mod opponent;
mod opponents;
mod pool;
mod self_play_env;

pub use learner::SelfPlayLearner;
pub use opponent::Opponent;
pub use opponents::{Opponents, PoolMember};
pub use pool::{BoutResults, Pool};
pub use self_play_env::SelfPlayEnv;
use serde::{Deserialize, Serialize};

/// Everything that may be chosen about self-play.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SelfPlay {
    /// Most policies among the opponents at a time: when another joins, the oldest leaves.
    pub pool: usize,
    /// Fraction of the bouts against scripted opponents.
    pub scripted: f64,
    /// Fraction of the bouts against the pool that the policy must win for a copy of it to join; a draw is half a
    /// win.
    pub win_rate: f64,
    /// Bouts since the last copy joined without which none does.
    pub games: u64,
    /// Updates after which a copy joins all the same; 0 for never.
    pub updates: u64,
    /// Factor by which what is known of earlier bouts counts less at every step.
    pub decay: f64,
}

impl Default for SelfPlay {
    fn default() -> Self {
        SelfPlay {
            pool: 4,
            // Of the shares that were tried the one with which fighters came to each other soonest.
            scripted: 0.5,
            win_rate: 0.8,
            games: 400,
            updates: 200,
            decay: 0.998,
        }
    }
}
