//! Oracle: the largest q.r - |r|^2 / 2 of every block in f64, of rows as the shader reads them.
//! Bar, for `search_score_lanes`, `search_score_tiled` and their twin: g(28) = 28 u / (1 - 28 u) times the
//! largest sum of absolute products, u = 2^-24 (Higham, section 3.1): what `search_exact` allows.

use crate::inputs::{Draw, close};
use crate::support::forms::Forms;
use footwork::gpu::shader::search_score_lanes::constants::{LANES, QUERIES};
use footwork::gpu::shader::search_score_tiled::constants::TILE;
use footwork::kernels::search::{search_score_lanes, search_score_tiled};
use footwork::motion::features::ROW_STRIDE;

/// Queries, rows, rows a block and blocks an invocation or workgroup.
pub const SHAPES: [[usize; 4]; 11] = [
    [1, 1, 64, 32],
    [63, 63, 64, 32],
    [64, 64, 64, 1],
    [65, 65, 64, 1],
    [255, 129, 64, 2],
    [256, 1000, 64, 3],
    [257, 1000, 64, 32],
    [1000, 1000, 128, 5],
    [65, 1000, 100, 4],
    [9, 1000, 1, 32],
    [7, 5000, 4096, 32],
];

pub struct Case {
    rows: Vec<[f32; ROW_STRIDE]>,
    queries: Vec<[f32; ROW_STRIDE]>,
    block: usize,
    run: usize,
}

impl Case {
    pub fn new([count, candidates, block, run]: [usize; 4], far: f32, seed: u32) -> Self {
        let mut draw = Draw::new(seed);
        let rows = draw.rows(candidates, 0.0);
        let scaled = |query: [f32; ROW_STRIDE]| {
            std::array::from_fn(|i| if i < 27 { query[i] * far } else { 1.0 })
        };
        Case {
            rows: rows
                .iter()
                .map(search_score_lanes::with_half_square)
                .collect(),
            queries: draw.rows(count, 1.0).into_iter().map(scaled).collect(),
            block,
            run,
        }
    }

    fn params(&self) -> search_score_lanes::Params {
        search_score_lanes::Params {
            count: self.queries.len() as u32,
            candidates: self.rows.len() as u32,
            block: self.block as u32,
            run: self.run as u32,
        }
    }

    fn tile_params(&self) -> search_score_tiled::Params {
        let search_score_lanes::Params {
            count,
            candidates,
            block,
            run,
        } = self.params();
        search_score_tiled::Params {
            count,
            candidates,
            block,
            run,
        }
    }

    /// Best score and largest sum of absolute products of every block and query.
    fn oracle(&self) -> Vec<(f64, f64)> {
        let products = |row: &[f32; ROW_STRIDE], query: &[f32; ROW_STRIDE]| {
            let terms = row
                .iter()
                .zip(query)
                .map(|(&r, &q)| f64::from(r) * f64::from(q));
            terms.fold((0.0, 0.0), |(sum, absolute), term: f64| {
                (sum + term, absolute + term.abs())
            })
        };
        let best = |rows: &[[f32; ROW_STRIDE]], query| {
            let all = rows.iter().map(|row| products(row, query));
            all.fold((f64::MIN, 0.0), |a: (f64, f64), b| {
                (a.0.max(b.0), a.1.max(b.1))
            })
        };
        let blocks = self.rows.chunks(self.block);
        blocks
            .flat_map(|rows| self.queries.iter().map(move |query| best(rows, query)))
            .collect()
    }

    fn close(&self, forms: Forms<Vec<f32>>) {
        let oracle = self.oracle();
        let want: Vec<f32> = oracle.iter().map(|o| o.0 as f32).collect();
        let unit = f64::from(f32::EPSILON) / 2.0;
        // One more rounding: the oracle's, to be compared as f32.
        let g = 29.0 * unit / (1.0 - 29.0 * unit);
        for (form, got) in forms.all() {
            close(form, got, &want, |i| (g * oracle[i].1) as f32);
        }
    }

    /// Workgroups, of so many queries each, and scores.
    fn sizes(&self, queries: u32) -> ([u32; 3], usize) {
        let blocks = self.rows.len().div_ceil(self.block);
        let runs = blocks.div_ceil(self.run) as u32;
        let groups = (self.queries.len() as u32).div_ceil(queries);
        ([groups, runs, 1], blocks * self.queries.len())
    }

    pub fn lanes_agree(&self) {
        let (groups, scores) = self.sizes(LANES * QUERIES);
        self.close(forms!(
            search_score_lanes, SEARCH_SCORE_LANES, groups, self.params();
            self.rows, self.queries, out scores
        ));
    }

    pub fn tiles_agree(&self) {
        let (groups, scores) = self.sizes(TILE);
        self.close(forms!(
            search_score_tiled, SEARCH_SCORE_TILED, groups, self.tile_params();
            self.rows, self.queries, out scores
        ));
    }
}

#[test]
fn agrees_with_its_twin_and_the_oracle() {
    for (seed, shape) in (0..).zip(SHAPES) {
        for far in [1.0, 1e4] {
            Case::new(shape, far, seed).lanes_agree();
        }
    }
}
