//! Levels of rising difficulty (Lee et al., section 4).

use super::stats::Stats;
use serde::{Deserialize, Serialize};

/// Least episodes a level is judged by.
const MIN_EPISODES: f64 = 100.0;

/// How far a run has come. A level is passed when the mean success of the latest episodes that
/// ended on it exceeds `promotion_success`: of the latest updates that hold a hundred of them, or a
/// quarter of the environments if that is more. Never down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curriculum {
    levels: u32,
    promotion_success: f64,
    /// Levels passed, up to all of them.
    pub passed: u32,
    /// Episodes and successes of the latest updates on this level.
    latest: Vec<[f64; 2]>,
}

impl Curriculum {
    /// Begins on the level `first` of `levels`.
    pub fn new(levels: u32, first: u32, promotion_success: f32) -> Self {
        Curriculum {
            levels,
            promotion_success: f64::from(promotion_success),
            passed: first,
            latest: Vec::new(),
        }
    }

    /// The level now trained on.
    pub fn level(&self) -> u32 {
        self.passed.min(self.levels - 1)
    }

    /// Takes an update's episodes in; whether a level was passed.
    pub fn advance(&mut self, stats: &Stats, envs: usize) -> bool {
        let enough = MIN_EPISODES.max(envs as f64 / 4.0);
        let sum = |latest: &[[f64; 2]], i: usize| latest.iter().map(|u| u[i]).sum::<f64>();
        self.latest
            .push([stats.sum("episodes"), stats.sum("successes")]);
        while sum(&self.latest[1..], 0) >= enough {
            self.latest.remove(0);
        }
        let (episodes, successes) = (sum(&self.latest, 0), sum(&self.latest, 1));
        let passed = self.passed < self.levels
            && episodes >= enough
            && successes > self.promotion_success * episodes;
        if passed {
            self.passed += 1;
            self.latest.clear();
        }
        passed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVELS: u32 = 10;

    fn stats(episodes: f32, successes: f32) -> Stats {
        Stats::new(&["episodes", "successes"], &[episodes, successes])
    }

    #[test]
    fn levels_are_passed_by_enough_recent_episodes_and_never_lost() {
        let mut run = Curriculum::new(LEVELS, 0, 0.4);
        let mut update = |episodes, successes| {
            let passed = run.advance(&stats(episodes, successes), 256);
            (passed, run.passed)
        };
        assert_eq!(update(99.0, 99.0), (false, 0), "too few");
        assert_eq!(update(1.0, 0.0), (true, 1), "99 of 100");
        assert_eq!(update(100.0, 40.0), (false, 1), "not above 40 %");
        assert_eq!(
            update(50.0, 50.0),
            (true, 2),
            "90 of 150: all of the last hundred count"
        );
        assert_eq!(update(0.0, 0.0), (false, 2), "a passed level starts anew");
        assert_eq!(update(1000.0, 0.0), (false, 2));
        assert_eq!(update(100.0, 41.0), (true, 3), "old failures are forgotten");
        for passed in 4..=LEVELS {
            assert_eq!(update(200.0, 200.0), (true, passed));
        }
        assert_eq!(
            update(200.0, 200.0),
            (false, LEVELS),
            "there is no eleventh"
        );
        assert_eq!(run.level(), LEVELS - 1);
    }

    #[test]
    fn many_environments_need_more_episodes() {
        let mut run = Curriculum::new(LEVELS, 0, 0.4);
        assert!(!run.advance(&stats(999.0, 999.0), 4000));
        assert!(run.advance(&stats(1.0, 1.0), 4000));
    }
}
