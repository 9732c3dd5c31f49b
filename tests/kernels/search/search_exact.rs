//! Oracle: `search_exact::twin`, which compares every row.
//! Bar: equal indices. Features are small integers, so that every form computes all scores and
//! distances without rounding and ties abound; real features follow in `search`.

use crate::checked;
use crate::inputs::{Draw, POISON, POISON_WHOLE, gpu};
use bytemuck::cast_slice;
use footwork::gpu::groups;
use footwork::gpu::{Buffer, shader};
use footwork::kernels::search::{search_exact, search_score_lanes};
use footwork::motion::features::{FEATURE_DIM, ROW_STRIDE};

struct Case {
    rows: Vec<[f32; ROW_STRIDE]>,
    queries: Vec<[f32; ROW_STRIDE]>,
    score: Vec<f32>,
    params: search_exact::Params,
}

impl Case {
    fn new(rows: &[[f32; ROW_STRIDE]], queries: Vec<[f32; ROW_STRIDE]>, block: u32) -> Self {
        let rows: Vec<_> = rows
            .iter()
            .map(search_score_lanes::with_half_square)
            .collect();
        let max_norm = rows
            .iter()
            .map(|row| -2.0 * row[FEATURE_DIM])
            .fold(0.0, f32::max);
        let (count, candidates) = (queries.len() as u32, rows.len() as u32);
        let blocks = rows.len().div_ceil(block as usize);
        let mut score = vec![POISON; blocks * queries.len()];
        let params = search_score_lanes::Params {
            count,
            candidates,
            block,
            run: 1,
        };
        search_score_lanes::twin(&rows, &queries, &mut score, &params);
        Case {
            rows,
            queries,
            score,
            params: search_exact::Params {
                count,
                candidates,
                block,
                max_norm: max_norm.sqrt(),
            },
        }
    }

    /// More places than queries: those past the end must stay untouched.
    fn matched(&self) -> Vec<u32> {
        vec![POISON_WHOLE; self.queries.len() + 3]
    }

    fn twin(&self) -> Vec<u32> {
        let mut matched = self.matched();
        search_exact::twin(
            &self.rows,
            &self.queries,
            &self.score,
            &mut matched,
            &self.params,
        );
        matched
    }

    fn launch(&self) -> Vec<u32> {
        let gpu = gpu();
        let matched = Buffer::from_slice(&gpu, &self.matched());
        search_exact::launch(
            &gpu,
            &Buffer::from_slice(&gpu, self.rows.as_flattened()),
            &Buffer::from_slice(&gpu, self.queries.as_flattened()),
            &Buffer::from_slice(&gpu, &self.score),
            &matched,
            &self.params,
        );
        matched.read(&gpu).expect("matches")
    }

    fn checked(&self) -> Vec<u32> {
        let groups = groups(&shader::SEARCH_EXACT, self.queries.len());
        self.params
            .block_runs()
            .fold(self.matched(), |matched, run| {
                let buffers: [&[u8]; 4] = [
                    cast_slice(&self.rows),
                    cast_slice(&self.queries),
                    cast_slice(&self.score),
                    cast_slice(&matched),
                ];
                checked::run(&shader::SEARCH_EXACT, groups, &buffers, &run).of(3)
            })
    }

    fn agrees(&self) {
        let twin = self.twin();
        let what = format!("{:?}", self.params);
        assert_eq!(self.launch(), twin, "launched, {what}");
        assert_eq!(self.checked(), twin, "checked, {what}");
    }
}

/// Small integers: sums of their products and squares are exact in any order.
fn whole_rows(draw: &mut Draw, count: usize, half: usize, last: f32) -> Vec<[f32; ROW_STRIDE]> {
    let mut number = || draw.below(2 * half + 1) as f32 - half as f32;
    (0..count)
        .map(|_| std::array::from_fn(|i| if i < FEATURE_DIM { number() } else { last }))
        .collect()
}

#[test]
fn finds_the_lowest_of_many_ties() {
    for (seed, count, candidates, block) in [
        (1, 1, 1, 64),
        (2, 63, 2, 64),
        (3, 64, 63, 64),
        (4, 65, 64, 64),
        (5, 1000, 65, 64),
        (6, 65, 1000, 64),
        (7, 65, 1000, 1),
        (8, 65, 1000, 100),
        (9, 65, 1000, 4096),
    ] {
        let mut draw = Draw::new(seed);
        let rows = whole_rows(&mut draw, candidates, 1, 0.0);
        let queries = whole_rows(&mut draw, count, 1, 1.0);
        Case::new(&rows, queries, block).agrees();
    }
}

#[test]
fn of_equal_rows_the_first_wins() {
    let mut draw = Draw::new(1);
    let rows = vec![whole_rows(&mut draw, 1, 8, 0.0)[0]; 1000];
    let case = Case::new(&rows, whole_rows(&mut draw, 65, 8, 1.0), 64);
    case.agrees();
    assert!(case.twin()[..65].iter().all(|&found| found == 0));
}

/// Rows at the origin but for `near`, and a query so far away that rounding leaves every block in
/// question.
fn far_query(rows: usize, near: &[usize]) -> Case {
    let mut data = vec![[0.0; ROW_STRIDE]; rows];
    for &row in near {
        data[row][1] = 1.0;
    }
    let mut query = [0.0; ROW_STRIDE];
    (query[0], query[1], query[FEATURE_DIM]) = (500.0, 1.0, 1.0);
    Case::new(&data, vec![query; 9], 64)
}

#[test]
fn looks_at_more_rows_than_a_software_adapter_loops() {
    for rows in [65_535, 65_536, 70_000, 131_072, 131_073, 280_000] {
        for near in [&[rows - 1][..], &[0], &[rows / 2, rows - 1]] {
            let case = far_query(rows, near);
            assert_eq!(case.launch()[..9], [near[0] as u32; 9], "{rows} rows");
        }
    }
}

#[test]
fn a_far_query_agrees_across_launches() {
    far_query(140_000, &[131_072, 139_999]).agrees();
}
