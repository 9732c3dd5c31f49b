//! What a simulated body is to move like: the recorded frame that it is nearest to, played on.

use crate::env::humanoid::recorded::observe;
use crate::env::humanoid::task::DT;
use crate::physics::model::Model;
use crate::physics::motion_library::MotionLibrary;
use rayon::prelude::*;
use std::sync::Arc;

/// A recording is left for a frame that is nearer than this fraction of the squared distance to it.
const MUCH_NEARER: f32 = 0.5;

/// All frames of a library, by what a body observes of itself there.
pub struct Reference {
    library: Arc<MotionLibrary>,
    /// Motion of each frame and the time in it, s.
    frames: Vec<(usize, f32)>,
    /// `[frames][dim]`
    observations: Vec<f32>,
    /// One over the variance of each number, `[dim]`.
    weights: Vec<f32>,
}

impl Reference {
    /// The frames of a library, a step apart.
    pub fn new(library: &Arc<MotionLibrary>) -> Reference {
        let motions = library.motions().iter().enumerate();
        let frames: Vec<(usize, f32)> = motions
            .flat_map(|(number, motion)| {
                let steps = (motion.seconds() / DT + 1e-3) as usize;
                (0..=steps).map(move |step| (number, step as f32 * DT))
            })
            .collect();
        let rows: Vec<Vec<f32>> = frames
            .par_iter()
            .map(|&(motion, time)| {
                let (q, v) = library.at(motion, time);
                observe(library.model(), &q, &v)
            })
            .collect();
        Reference {
            library: library.clone(),
            weights: inv_variances(&rows),
            observations: rows.concat(),
            frames,
        }
    }

    /// The frame after another or, where a body is much nearer to one, that.
    pub fn follow(&self, before: Option<usize>, body: &[f32]) -> usize {
        let nearest = self.nearest(body);
        let next = before.map(|before| before + 1).filter(|&next| {
            let goes_on = self.frames.get(next).is_some_and(|(_, time)| *time > 0.0);
            goes_on && self.distance(nearest, body) > MUCH_NEARER * self.distance(next, body)
        });
        next.unwrap_or(nearest)
    }

    /// The model that is recorded.
    pub fn model(&self) -> &Model {
        self.library.model()
    }

    /// Positions of a frame.
    pub fn q(&self, frame: usize) -> Vec<f32> {
        let (motion, time) = self.frames[frame];
        self.library.at(motion, time).0
    }

    /// The recording that a frame is of, and the time in it, s.
    pub fn name(&self, frame: usize) -> (&str, f32) {
        let (motion, time) = self.frames[frame];
        (&self.library.motions()[motion].name, time)
    }

    fn nearest(&self, body: &[f32]) -> usize {
        let distances = (0..self.frames.len()).map(|frame| self.distance(frame, body));
        let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map_or(0, |(frame, _)| frame)
    }

    /// Squared, each number over its variance.
    fn distance(&self, frame: usize, body: &[f32]) -> f32 {
        let dim = self.weights.len();
        let row = &self.observations[frame * dim..][..dim];
        let numbers = row.iter().zip(body).zip(&self.weights);
        numbers
            .map(|((a, b), weight)| weight * (a - b) * (a - b))
            .sum()
    }
}

fn inv_variances(rows: &[Vec<f32>]) -> Vec<f32> {
    let count = rows.len().max(1) as f32;
    let mean = |of: &dyn Fn(&[f32]) -> f32| rows.iter().map(|row| of(row)).sum::<f32>() / count;
    let dim = rows.first().map_or(0, Vec::len);
    let variance = |i: usize| {
        let middle = mean(&|row| row[i]);
        mean(&|row| (row[i] - middle).powi(2))
    };
    // What never changes says nothing.
    (0..dim)
        .map(|i| match variance(i) {
            still if still < 1e-6 => 0.0,
            moving => 1.0 / moving,
        })
        .collect()
}
