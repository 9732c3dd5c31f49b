//! The nearest row by plain loops in f64, and what may differ from it.

use footwork::motion::features::{FEATURE_DIM, ROW_STRIDE};
use multiversion::multiversion;
use rayon::prelude::*;
use std::collections::HashMap;

/// Queries compared at once: vector lanes.
const LANES: usize = 8;

pub struct Oracle {
    rows: Vec<[f64; FEATURE_DIM]>,
    /// For every row the first one equal to it.
    first: Vec<usize>,
}

impl Oracle {
    pub fn new(rows: &[[f32; ROW_STRIDE]]) -> Self {
        let mut seen = HashMap::new();
        let first = rows.iter().enumerate().map(|(index, row)| {
            // -0 and 0 are one number.
            let key: [u32; FEATURE_DIM] = std::array::from_fn(|i| (row[i] + 0.0).to_bits());
            *seen.entry(key).or_insert(index)
        });
        Oracle {
            first: first.collect(),
            rows: rows.iter().map(wide).collect(),
        }
    }

    /// Nearest row of every query; of equals the lowest.
    pub fn nearest_all(&self, queries: &[[f32; ROW_STRIDE]]) -> Vec<usize> {
        let chunks = queries.par_chunks(LANES);
        chunks
            .flat_map_iter(|queries| {
                let mut lanes = [[0.0; LANES]; FEATURE_DIM];
                for (lane, query) in queries.iter().enumerate() {
                    for (lanes, &number) in lanes.iter_mut().zip(query) {
                        lanes[lane] = f64::from(number);
                    }
                }
                nearest(&self.rows, &lanes).into_iter().take(queries.len())
            })
            .collect()
    }

    fn squared(&self, row: usize, query: &[f32; ROW_STRIDE]) -> f64 {
        let pairs = self.rows[row].iter().zip(wide(query));
        pairs.map(|(r, q)| (r - q) * (r - q)).sum()
    }

    /// Fails unless `found` is the oracle's `best` or a proven tie.
    ///
    /// An f32 distance has a rounding in each difference, counted twice by its square, at most
    /// eight in a chain of products and sums and two in the last sums: it is wrong by at most
    /// g = 12 u / (1 - 12 u) of itself, u = 2^-24. So a row is preferred to a nearer one only if
    /// their distances differ by at most g times their sum. Equal rows have equal distances in
    /// any arithmetic: of those the first must be found.
    #[track_caller]
    pub fn check(&self, what: &str, query: &[f32; ROW_STRIDE], found: u32, best: usize) {
        let found = found as usize;
        let unit = f64::from(f32::EPSILON) / 2.0;
        let g = 12.0 * unit / (1.0 - 12.0 * unit);
        assert!(
            found < self.rows.len(),
            "{what}: row {found} does not exist"
        );
        assert_eq!(
            self.first[found], found,
            "{what}: an equal row comes before"
        );
        let (far, near) = (self.squared(found, query), self.squared(best, query));
        let tie = far - near <= g * (far + near);
        assert!(
            tie,
            "{what}: row {found} at {far:e} instead of {best} at {near:e}"
        );
    }
}

fn wide(row: &[f32; ROW_STRIDE]) -> [f64; FEATURE_DIM] {
    std::array::from_fn(|i| f64::from(row[i]))
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "aarch64+neon"))]
fn nearest(rows: &[[f64; FEATURE_DIM]], queries: &[[f64; LANES]; FEATURE_DIM]) -> [usize; LANES] {
    let (mut least, mut found) = ([f64::INFINITY; LANES], [0; LANES]);
    for (index, row) in rows.iter().enumerate() {
        let mut sum = [0.0; LANES];
        for (row, query) in row.iter().zip(queries) {
            for (sum, query) in sum.iter_mut().zip(query) {
                *sum += (row - query) * (row - query);
            }
        }
        for lane in 0..LANES {
            if sum[lane] < least[lane] {
                (least[lane], found[lane]) = (sum[lane], index);
            }
        }
    }
    found
}
