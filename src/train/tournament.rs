//! Who beats whom: a round robin of policies that fight.

use super::body_episodes::EPISODES_SEED;
use super::elo::ratings;
use crate::env::humanoid::boxing::BoxingTask;
use crate::env::humanoid::boxing::evaluate::{BoxingReport, evaluate};
use crate::env::humanoid::driver::BodyDriver;
use crate::report::table::table;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;

/// What policies of a task fight in.
pub struct Bouts {
    /// The task.
    pub task: Arc<BoxingTask>,
    /// Those whom nobody has trained, the least active first.
    pub anchors: Vec<TournamentPlayer>,
}

/// Somebody who fights.
pub struct TournamentPlayer {
    /// In tables.
    pub name: String,
    /// Moves the fighter.
    pub driver: Box<dyn BodyDriver>,
}

/// How a tournament ended.
#[derive(Debug, PartialEq, Serialize)]
pub struct TournamentReport {
    /// In the order they were given.
    pub players: Vec<RankedPlayer>,
    /// Bouts that the player of the row won against that of the column.
    pub wins: Vec<Vec<usize>>,
    /// Bouts between any two; what neither won was drawn.
    pub bouts: usize,
}

/// A player with its rating: see [`ratings`].
#[derive(Debug, PartialEq, Serialize)]
pub struct RankedPlayer {
    /// In tables.
    pub name: String,
    /// Rating.
    pub elo: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Lets each of the players fight every other in `2 * half` bouts, half of them in either corner, from the same starts.
pub fn play(task: &Arc<BoxingTask>, players: &[TournamentPlayer], half: usize) -> TournamentReport {
    let count = players.len();
    let pairs = (0..count * count).map(|pair| [pair / count, pair % count]);
    let pairs: Vec<[usize; 2]> = pairs.filter(|[red, blue]| red != blue).collect();
    // Policies act on one core: bouts of several pairs keep all of them busy.
    let found = pairs.par_iter().map(|pair| {
        let corners = pair.map(|player| &*players[player].driver);
        evaluate(task.clone(), corners, half, EPISODES_SEED)
    });
    let found: Vec<BoxingReport> = found.collect();
    let mut wins = vec![vec![0; count]; count];
    for ([red, blue], found) in pairs.into_iter().zip(found) {
        wins[red][blue] += (found.won * half as f64).round() as usize;
        wins[blue][red] += (found.lost * half as f64).round() as usize;
    }
    let names = players.iter().map(|player| player.name.clone());
    TournamentReport::new(names.collect(), wins, 2 * half)
}

impl TournamentReport {
    /// Rates players by who won how often, in so many bouts between any two.
    pub fn new(names: Vec<String>, wins: Vec<Vec<usize>>, bouts: usize) -> TournamentReport {
        let score = |one: usize, other: usize| match one == other {
            true => 0.0,
            false => {
                let [won, lost] = [wins[one][other], wins[other][one]];
                let drawn = bouts.saturating_sub(won + lost);
                won as f64 + 0.5 * drawn as f64
            }
        };
        let row = |one: usize| (0..names.len()).map(|other| score(one, other)).collect();
        let scores: Vec<Vec<f64>> = (0..names.len()).map(row).collect();
        let rated = names.into_iter().zip(ratings(&scores));
        let ranked = rated.map(|(name, rating)| RankedPlayer {
            name,
            elo: rating.elo,
            low: rating.low,
            high: rating.high,
        });
        TournamentReport {
            players: ranked.collect(),
            wins,
            bouts,
        }
    }

    /// Fraction of the bouts that one player won against another; none against itself.
    pub fn win_rate(&self, one: usize, other: usize) -> Option<f64> {
        (one != other).then(|| self.wins[one][other] as f64 / self.bouts.max(1) as f64)
    }

    /// A table of all: ratings, and percents of bouts won against each by number.
    pub fn summary(&self) -> String {
        let numbers: Vec<String> = (1..=self.players.len()).map(|n| n.to_string()).collect();
        let mut titles = vec!["", "player", "elo", "in 95 of 100 cases"];
        titles.extend(numbers.iter().map(String::as_str));
        let row = |one: usize| {
            let player = &self.players[one];
            let rates = (0..self.players.len()).map(|other| match self.win_rate(one, other) {
                Some(rate) => format!("{:.0}", 100.0 * rate),
                None => "-".to_string(),
            });
            let mut row = vec![
                numbers[one].clone(),
                player.name.clone(),
                format!("{:.0}", player.elo),
                format!("{:.0} to {:.0}", player.low, player.high),
            ];
            row.extend(rates);
            row
        };
        table(
            &titles,
            &(0..self.players.len()).map(row).collect::<Vec<_>>(),
        )
    }
}
