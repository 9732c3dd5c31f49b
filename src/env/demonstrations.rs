//! Recorded motion as a discriminator sees it.

use crate::kernels::rng::uniform01;

/// Windows of recorded motion, each as likely to be drawn as its share of all weights.
#[derive(Clone, Debug)]
pub struct Demonstrations {
    /// Numbers of a window: two moments, each as the first numbers of an observation.
    pub dim: usize,
    /// `[windows][dim]`
    pub windows: Vec<f32>,
    /// Shares of the weights of each window and all before it; the last is 1.
    shares: Vec<f32>,
}

impl Demonstrations {
    /// Windows `[n][dim]` with their weights, `[n]`, of which none is negative and one at least positive.
    pub fn new(dim: usize, windows: Vec<f32>, weights: &[f64]) -> Self {
        let total: f64 = weights.iter().sum();
        let sums = weights.iter().scan(0.0, |sum, weight| {
            *sum += weight;
            Some((*sum / total) as f32)
        });
        let mut shares: Vec<f32> = sums.collect();
        if let Some(last) = shares.last_mut() {
            *last = 1.0;
        }
        Demonstrations {
            dim,
            windows,
            shares,
        }
    }

    /// Number of windows.
    pub fn len(&self) -> usize {
        self.shares.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.shares.is_empty()
    }

    /// The number of a window, drawn by weight with random bits.
    pub fn draw(&self, bits: u32) -> u32 {
        let share = uniform01(bits);
        let index = self.shares.partition_point(|&upto| upto <= share);
        index.min(self.len() - 1) as u32
    }
}
