//! What the search found, and what it nearly found.

use crate::motion::database::Database;
use crate::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE};

/// A candidate and its distance to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Frame of the database.
    pub frame: usize,
    /// Squared distances: of the pose's features and of the trajectory's.
    pub pose: f32,
    /// Squared distance of the trajectories.
    pub trajectory: f32,
}

impl Found {
    /// Squared distance of the whole features.
    pub fn total(&self) -> f32 {
        self.pose + self.trajectory
    }
}

/// Candidates this close to a better one are the same motion, frames.
const APART: usize = 15;

/// The `count` nearest pieces of motion, the nearest first.
pub fn nearest(database: &Database, query: &[f32; ROW_STRIDE], count: usize) -> Vec<Found> {
    let mut all: Vec<Found> = database
        .candidates
        .iter()
        .map(|&frame| distance(database, query, frame as usize))
        .collect();
    let mut best: Vec<Found> = Vec::with_capacity(count);
    while best.len() < count {
        all.retain(|found| !best.last().is_some_and(|last| same(last, found)));
        let nearest = all.iter().min_by(|a, b| a.total().total_cmp(&b.total()));
        let Some(&nearest) = nearest else {
            break;
        };
        best.push(nearest);
    }
    best
}

fn same(a: &Found, b: &Found) -> bool {
    a.frame.abs_diff(b.frame) < APART
}

fn distance(database: &Database, query: &[f32; ROW_STRIDE], frame: usize) -> Found {
    let row = &database.features[frame];
    let part = |of: std::ops::Range<usize>| {
        let squares = of.map(|i| (row[i] - query[i]) * (row[i] - query[i]));
        squares.sum()
    };
    Found {
        frame,
        pose: part(0..POSE_DIM),
        trajectory: part(POSE_DIM..FEATURE_DIM),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::normalise::Weights;
    use crate::motion::synthetic;

    #[test]
    fn the_best_comes_first_and_pieces_lie_apart() {
        let (clips, roles) = synthetic::perform(1, 0.5);
        let database = Database::build(&clips, roles, Weights::PAPER).expect("long enough");
        let frame = database.candidates[100] as usize;
        let found = nearest(&database, &database.features[frame], 6);
        assert_eq!((found[0].frame, found[0].total()), (frame, 0.0));
        for (place, one) in found.iter().enumerate().skip(1) {
            assert!(one.total() >= found[place - 1].total());
            assert!(found[..place].iter().all(|better| !same(better, one)));
        }
    }
}
