//! Ratings of players from who beat whom.

/// Mean of all ratings.
pub const MEAN: f64 = 400.0;
/// Points between two players of whom one wins ten times as often as the other.
const SCALE: f64 = 400.0;
/// Standard errors of an interval that holds the rating in 95 of 100 cases.
const ERRORS: f64 = 1.96;
/// Rounds in which the ratings settle.
const ROUNDS: usize = 2000;

/// How good a player is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EloRating {
    /// The most likely rating.
    pub elo: f64,
    /// Where it lies in 95 of 100 cases, the others' ratings being right.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

/// The most likely ratings (Bradley and Terry 1952) of players who won `scores[one][other]` bouts against each other,
/// draws being half a win of both. To these one draw is added between all who met, which keeps finite who always wins.
/// Unlike ratings that follow bout by bout they do not depend on the order of bouts.
pub fn ratings(scores: &[Vec<f64>]) -> Vec<EloRating> {
    let scores = with_draws(scores);
    let strengths = strengths(&scores);
    let count = strengths.len();
    let rating = |one: usize| {
        let elo = MEAN + SCALE * strengths[one].log10();
        let information = (0..count).map(|other| {
            let expected = strengths[one] / (strengths[one] + strengths[other]);
            (scores[one][other] + scores[other][one]) * expected * (1.0 - expected)
        });
        let error = 1.0 / information.sum::<f64>().max(1e-9).sqrt();
        let margin = ERRORS * error * SCALE / std::f64::consts::LN_10;
        EloRating {
            elo,
            low: elo - margin,
            high: elo + margin,
        }
    };
    (0..count).map(rating).collect()
}

fn with_draws(scores: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let met =
        |one: usize, other: usize| one != other && scores[one][other] + scores[other][one] > 0.0;
    let score = |one: usize, other: usize| match met(one, other) {
        true => scores[one][other] + 0.5,
        false => 0.0,
    };
    let players = 0..scores.len();
    let row = |one: usize| players.clone().map(|other| score(one, other)).collect();
    players.clone().map(row).collect()
}

/// Strengths whose ratios are the odds of a bout, with a geometric mean of 1: Zermelo's iteration, which only ever makes
/// the scores likelier.
fn strengths(scores: &[Vec<f64>]) -> Vec<f64> {
    let count = scores.len();
    let mut strengths = vec![1.0f64; count];
    for _ in 0..ROUNDS {
        let better = |one: usize| {
            let won: f64 = scores[one].iter().sum();
            let expected = (0..count).map(|other| {
                let bouts = scores[one][other] + scores[other][one];
                bouts / (strengths[one] + strengths[other])
            });
            match expected.sum::<f64>() {
                0.0 => 1.0,
                expected => won / expected,
            }
        };
        let next: Vec<f64> = (0..count).map(better).collect();
        let mean = next.iter().map(|strength| strength.ln()).sum::<f64>() / count.max(1) as f64;
        strengths = next.iter().map(|strength| strength / mean.exp()).collect();
    }
    strengths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_players_are_as_far_apart_as_their_odds() {
        // 17.5 to 2.5 with the draw: odds of 7.
        let found = ratings(&[vec![0.0, 17.0], vec![2.0, 0.0]]);
        assert!((found[0].elo - found[1].elo - 400.0 * 7f64.log10()).abs() < 1e-6);
        assert!((found[0].elo + found[1].elo - 2.0 * MEAN).abs() < 1e-6);
        assert!(
            found
                .iter()
                .all(|one| one.low < one.elo && one.elo < one.high)
        );
    }

    #[test]
    fn equals_are_rated_alike_and_winners_finitely() {
        let draws = ratings(&vec![vec![5.0; 3]; 3]);
        assert!(draws.iter().all(|one| (one.elo - MEAN).abs() < 1e-6));
        let sure = ratings(&[vec![0.0, 100.0], vec![0.0, 0.0]]);
        assert!(sure[0].elo.is_finite() && sure[0].elo > sure[1].elo + 800.0);
        let nobody = ratings(&[vec![0.0; 2], vec![0.0; 2]]);
        assert!(nobody.iter().all(|one| one.elo == MEAN));
    }

    /// Odds of 4, 2 and 1 against each other, in any order of the players.
    #[test]
    fn the_order_of_players_is_no_matter() {
        let strengths = [4.0, 2.0, 1.0];
        let scores = |order: [usize; 3]| -> Vec<Vec<f64>> {
            let score = |one: usize, other: usize| match one == other {
                true => 0.0,
                false => 3000.0 * strengths[one] / (strengths[one] + strengths[other]),
            };
            let row = |&one: &usize| order.iter().map(|&other| score(one, other)).collect();
            order.iter().map(row).collect()
        };
        let found = ratings(&scores([0, 1, 2]));
        let other = ratings(&scores([2, 0, 1]));
        for (one, again) in [(0, 1), (1, 2), (2, 0)] {
            assert!((found[one].elo - other[again].elo).abs() < 1e-6);
            let wanted = MEAN + 400.0 * (strengths[one] / 2.0).log10();
            assert!((found[one].elo - wanted).abs() < 1.0, "{found:?}");
        }
    }

    #[test]
    fn more_bouts_make_surer() {
        let width = |bouts: f64| {
            let found = ratings(&[vec![0.0, bouts], vec![bouts, 0.0]]);
            found[0].high - found[0].low
        };
        assert!((width(4.0 * 50.0) / width(50.0) - 0.5).abs() < 0.01);
    }
}
