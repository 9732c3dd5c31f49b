//! Whole searches, on the CPU and in both forms on the GPU.
//! Oracle: plain loops in f64, and `search_exact::twin` for the CPU. Bar: no mismatch beyond
//! proven ties, see `Oracle::check`; index and distance of the CPU equal the twin's bit for bit.

use crate::inputs::{Draw, gpu};
use crate::oracle::Oracle;
use footwork::gpu::{Buffer, Gpu};
use footwork::kernels::search::search_exact;
use footwork::matching::gpu::brute_force::BruteForceSearch;
use footwork::matching::gpu::indexed::IndexedSearch;
use footwork::matching::{DEFAULT_TABLE_BYTES, Index};
use footwork::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE};
use footwork::motion::normalise::Weights;
use footwork::train::data;
use proptest::prelude::*;
use std::sync::LazyLock;

type Rows = Vec<[f32; ROW_STRIDE]>;

/// Queries of each kind, those put to `search_score_tiled` (slow on lavapipe) and to the slow twin.
const ALL: usize = 10_000;
const BY_TILED: usize = 1_000;
const BY_TWIN: usize = 100;

/// Queries with the rows they are put to and the oracle's results.
struct Kind {
    name: &'static str,
    data: &'static Data,
    queries: Rows,
    best: Vec<usize>,
}

struct Data {
    rows: Rows,
    oracle: Oracle,
}

impl Data {
    fn new(rows: Rows) -> Self {
        Data {
            oracle: Oracle::new(&rows),
            rows,
        }
    }
}

static SYNTHETIC: LazyLock<Data> = LazyLock::new(|| {
    let (database, _) = data::load(None, Weights::PAPER).expect("synthetic motion");
    Data::new(database.rows())
});

/// A third of the rows are copies of others.
static DUPLICATED: LazyLock<Data> = LazyLock::new(|| {
    let mut draw = Draw::new(1);
    let mut rows = SYNTHETIC.rows.clone();
    for _ in 0..rows.len() / 3 {
        let (from, to) = (draw.below(rows.len()), draw.below(rows.len()));
        rows[to] = rows[from];
    }
    Data::new(rows)
});

static KINDS: LazyLock<Vec<Kind>> = LazyLock::new(|| {
    let mut draw = Draw::new(2);
    let rows = &SYNTHETIC.rows;
    let on_policy = |draw: &mut Draw, i: usize| {
        let (mut query, future) = (rows[draw.below(rows.len())], rows[draw.below(rows.len())]);
        // From the future of another row to the wild queries of a new policy.
        let noise = [0.1, 0.3, 1.0, 3.0][i % 4];
        for d in POSE_DIM..FEATURE_DIM {
            query[d] = future[d] + noise * draw.normal();
        }
        query
    };
    let far = |draw: &mut Draw, i: usize| draw.row(0.0).map(|v| v * [1e3, 1e5][i % 2]);
    let copied = |draw: &mut Draw, i: usize| {
        let noise = [0.0, 1e-6, 1e-2][i % 3];
        let row = DUPLICATED.rows[draw.below(DUPLICATED.rows.len())];
        row.map(|value| value + noise * draw.normal())
    };
    vec![
        Kind::new("random", &SYNTHETIC, |_| draw.row(0.0)),
        Kind::new("on-policy", &SYNTHETIC, |i| on_policy(&mut draw, i)),
        Kind::new("far-away", &SYNTHETIC, |i| far(&mut draw, i)),
        Kind::new("duplicated", &DUPLICATED, |i| copied(&mut draw, i)),
    ]
});

impl Kind {
    fn new(
        name: &'static str,
        data: &'static Data,
        query: impl FnMut(usize) -> [f32; ROW_STRIDE],
    ) -> Self {
        let mut queries: Rows = (0..ALL).map(query).collect();
        for query in &mut queries {
            query[FEATURE_DIM] = 1.0;
        }
        Kind {
            name,
            best: data.oracle.nearest_all(&queries),
            data,
            queries,
        }
    }

    /// Checks the results of the first queries, and counts those that are ties.
    fn check(&self, form: &str, found: &[u32]) {
        let mut ties = 0;
        for (at, &found) in found.iter().enumerate() {
            let what = format!("{form}, {} query {at}", self.name);
            let (query, best) = (&self.queries[at], self.best[at]);
            self.data.oracle.check(&what, query, found, best);
            ties += usize::from(found as usize != best);
        }
        println!("{form}, {}: {ties} ties of {}", self.name, found.len());
    }
}

/// A form of the GPU's search.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Form {
    /// For software adapters.
    Index,
    /// Among all rows, the kernels for software adapters.
    Lanes,
    /// Among all rows, those for real ones.
    Tiled,
}

const FORMS: [Form; 3] = [Form::Index, Form::Lanes, Form::Tiled];

fn on_gpu(form: Form, rows: &[[f32; ROW_STRIDE]], queries: &[[f32; ROW_STRIDE]]) -> Vec<u32> {
    let mut gpu = gpu();
    gpu.software = form != Form::Tiled;
    let asked = Buffer::from_slice(&gpu, queries.as_flattened());
    if form == Form::Index {
        let indexed = Indexed::new(rows, queries, DEFAULT_TABLE_BYTES);
        return indexed.on_gpu(&gpu, &asked);
    }
    let search = BruteForceSearch::new(&gpu, rows, queries.len());
    search.nearest(&gpu, &asked).read(&gpu).expect("matches")
}

fn by_twin(rows: &[[f32; ROW_STRIDE]], queries: &[[f32; ROW_STRIDE]]) -> Vec<u32> {
    let mut found = vec![u32::MAX; queries.len()];
    let params = search_exact::Params {
        count: queries.len() as u32,
        candidates: rows.len() as u32,
        block: 64,
        max_norm: 0.0,
    };
    search_exact::twin(rows, queries, &[], &mut found, &params);
    found
}

/// An index of `rows` in a database where the queries' poses are frames too, behind the rows.
struct Indexed<'a> {
    index: Index,
    rows: &'a [[f32; ROW_STRIDE]],
    queries: &'a [[f32; ROW_STRIDE]],
}

impl<'a> Indexed<'a> {
    fn new(rows: &'a [[f32; ROW_STRIDE]], queries: &'a [[f32; ROW_STRIDE]], memory: usize) -> Self {
        let candidates: Vec<u32> = (0..rows.len() as u32).collect();
        Indexed {
            index: Index::build(&[rows, queries].concat(), &candidates, memory),
            rows,
            queries,
        }
    }

    fn frame(&self, query: usize) -> u32 {
        (self.rows.len() + query) as u32
    }

    fn frames(&self) -> Vec<u32> {
        (0..self.queries.len()).map(|q| self.frame(q)).collect()
    }

    fn on_gpu(&self, gpu: &Gpu, queries: &Buffer<f32>) -> Vec<u32> {
        let search = IndexedSearch::new(gpu, &self.index, self.queries.len());
        let shown = Buffer::from_slice(gpu, &self.frames());
        let found = search.nearest(gpu, &shown, queries);
        found.read(gpu).expect("matches")
    }

    fn nearest_all(&self) -> Vec<u32> {
        let frames = self.frames();
        let mut found = vec![u32::MAX; frames.len()];
        self.index.nearest_all(&frames, self.queries, &mut found);
        found
    }
}

fn on_cpu(rows: &[[f32; ROW_STRIDE]], queries: &[[f32; ROW_STRIDE]]) -> Vec<u32> {
    Indexed::new(rows, queries, DEFAULT_TABLE_BYTES).nearest_all()
}

/// The index gives the twin's rows and distances, bit for bit, however little memory it is given, for one
/// query and for all together.
#[track_caller]
fn same_as_twin(rows: &[[f32; ROW_STRIDE]], queries: &[[f32; ROW_STRIDE]]) {
    let by_twin = by_twin(rows, queries);
    for memory in [DEFAULT_TABLE_BYTES, rows.len() * rows.len() / 1024, 0] {
        let indexed = Indexed::new(rows, queries, memory);
        same(&indexed, &by_twin);
    }
}

#[track_caller]
fn same(indexed: &Indexed, by_twin: &[u32]) {
    let Indexed {
        index,
        rows,
        queries,
    } = indexed;
    for (at, (query, &twin)) in queries.iter().zip(by_twin).enumerate() {
        let found = index.nearest(indexed.frame(at), query);
        let distance = search_exact::squared(&rows[twin as usize], query);
        assert_eq!(
            (found.index, found.distance.to_bits()),
            (twin, distance.to_bits())
        );
    }
    assert!(indexed.nearest_all() == by_twin);
}

#[test]
fn the_cpu_finds_what_the_oracle_finds() {
    for kind in &*KINDS {
        kind.check("cpu", &on_cpu(&kind.data.rows, &kind.queries));
        same_as_twin(&kind.data.rows, &kind.queries[..BY_TWIN]);
    }
}

#[test]
fn all_forms_of_the_gpu_find_what_the_oracle_finds() {
    for form in FORMS {
        for kind in &*KINDS {
            let count = if form == Form::Tiled { BY_TILED } else { ALL };
            let found = on_gpu(form, &kind.data.rows, &kind.queries[..count]);
            kind.check(&format!("{form:?}"), &found);
        }
    }
}

/// However little memory the index has, the GPU finds what the CPU finds.
#[test]
fn the_gpu_finds_what_the_cpu_finds_with_little_memory() {
    let kind = &KINDS[1];
    let queries = &kind.queries[..1000];
    let by_twin = on_cpu(&kind.data.rows, queries);
    for memory in [1 << 20, 0] {
        let indexed = Indexed::new(&kind.data.rows, queries, memory);
        let asked = Buffer::from_slice(&gpu(), queries.as_flattened());
        assert!(indexed.on_gpu(&gpu(), &asked) == by_twin);
    }
}

/// Around the sizes of leaves, groups, blocks and of lavapipe's count of loop iterations.
const COUNTS: [usize; 15] = [
    1, 2, 15, 16, 17, 63, 64, 65, 255, 256, 257, 4097, 65_535, 65_536, 70_001,
];

#[test]
fn finds_a_winner_in_the_first_and_in_the_last_row() {
    let mut draw = Draw::new(3);
    for count in COUNTS {
        let mut rows: Rows = (0..count)
            .map(|i| SYNTHETIC.rows[i % SYNTHETIC.rows.len()])
            .collect();
        let mut queries = draw.rows(3, 1.0);
        for (place, query, away) in [(0, 0, 20.0), (count - 1, 1, -20.0)] {
            rows[place] = queries[query].map(|value| value + away);
            rows[place][FEATURE_DIM] = 0.0;
            queries[query] = rows[place].map(|value| value + 1e-3);
            queries[query][FEATURE_DIM] = 1.0;
        }
        let oracle = Oracle::new(&rows);
        let best = oracle.nearest_all(&queries);
        assert_eq!(best[1], count - 1);
        assert!(count == 1 || best[0] == 0);
        same_as_twin(&rows, &queries);
        for form in FORMS {
            let found = on_gpu(form, &rows, &queries);
            assert_eq!(
                found[..2],
                [best[0] as u32, best[1] as u32],
                "{form:?}, {count} rows"
            );
            oracle.check(&format!("{form:?}"), &queries[2], found[2], best[2]);
        }
    }
}

#[test]
fn of_equal_rows_the_first_wins() {
    for count in [1, 16, 17, 257, 4097, 70_001] {
        let rows = vec![SYNTHETIC.rows[7]; count];
        let mut queries = Draw::new(4).rows(3, 1.0);
        queries[0][..FEATURE_DIM].copy_from_slice(&rows[0][..FEATURE_DIM]);
        queries[2] = queries[2].map(|value| value * 1e5);
        queries[2][FEATURE_DIM] = 1.0;
        assert_eq!(on_cpu(&rows, &queries), [0; 3]);
        for form in FORMS {
            let found = on_gpu(form, &rows, &queries);
            assert_eq!(found, [0; 3], "{form:?}, {count} rows");
        }
    }
}

/// Rows and queries huddled together far from the origin: block scores cancel almost wholly, and
/// only the margin for their rounding keeps the right block in question.
#[test]
fn finds_the_nearest_where_scores_cancel() {
    let mut draw = Draw::new(5);
    let centre = draw.row(0.0).map(|value| 1e3 * value);
    let mut huddle = |count: usize, last: f32| -> Rows {
        let mut rows = draw.rows(count, 0.0);
        for row in &mut rows {
            *row = std::array::from_fn(|i| centre[i] + 0.1 * row[i]);
            row[FEATURE_DIM] = last;
        }
        rows
    };
    let (rows, queries) = (huddle(5000, 0.0), huddle(257, 1.0));
    let oracle = Oracle::new(&rows);
    let best = oracle.nearest_all(&queries);
    same_as_twin(&rows, &queries);
    for form in FORMS {
        let found = on_gpu(form, &rows, &queries);
        for ((query, found), &best) in queries.iter().zip(found).zip(&best) {
            oracle.check(&format!("{form:?}"), query, found, best);
        }
    }
}

/// With so many queries the scores of blocks of 64 rows would not fit one binding. Both devices
/// sum alike, so they agree without tolerance.
#[test]
fn finds_the_nearest_for_tens_of_thousands_of_queries_at_once() {
    let rows = &SYNTHETIC.rows;
    let queries = Draw::new(11).rows(35_000, 1.0);
    let by_cpu = on_cpu(rows, &queries);
    assert!(on_gpu(Form::Index, rows, &queries) == by_cpu);
    assert!(on_gpu(Form::Lanes, rows, &queries) == by_cpu);
}

/// A diverged policy queries what is not a number: the result must still be a row.
#[test]
fn a_query_that_is_no_number_finds_a_row() {
    let rows = Draw::new(9).rows(300, 0.0);
    for bad in [f32::NAN, f32::INFINITY, f32::MAX] {
        let queries = [[bad; ROW_STRIDE], rows[7]];
        assert_eq!(on_cpu(&rows, &queries), [0, 7], "{bad}");
        let found = on_gpu(Form::Index, &rows, &queries);
        assert!(found[0] < 300 && found[1] == 7, "{bad}");
    }
}

/// A saved index finds what the built one finds; one of another database is not used.
#[test]
fn an_index_is_kept_in_a_file() {
    let rows = &SYNTHETIC.rows[..5000];
    let queries: Rows = (0..200).map(|i| KINDS[1].queries[i]).collect();
    let frames = [rows, &queries].concat();
    let candidates: Vec<u32> = (0..rows.len() as u32).collect();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("index");
    for memory in [DEFAULT_TABLE_BYTES, 0] {
        let built = Index::build(&frames, &candidates, memory);
        built.save(&path, 7).expect("a file");
        let load =
            |fingerprint, frames, candidates| Index::load(&path, fingerprint, frames, candidates);
        let index = load(7, &frames, &candidates).expect("an index");
        assert_eq!(index.bytes(), built.bytes());
        let kept = Indexed {
            index,
            rows,
            queries: &queries,
        };
        same(&kept, &by_twin(rows, &queries));
        assert!(
            load(8, &frames, &candidates).is_none(),
            "another database's"
        );
        assert!(load(7, &frames[..4000], &candidates[..3000]).is_none());
    }
    let mut bytes = std::fs::read(&path).expect("the file");
    bytes[5000] ^= 1;
    std::fs::write(&path, bytes).expect("a damaged file");
    assert!(Index::load(&path, 7, &frames, &candidates).is_none());
    std::fs::remove_file(&path).expect("no file");
    assert!(Index::load(&path, 7, &frames, &candidates).is_none());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any weights: scales from 1e-6 to 1e6 a dimension, some of them 0; some rows twice.
    #[test]
    fn the_index_equals_the_twin_for_any_weights(
        seed: u32,
        count in 1usize..900,
        exponents in prop::collection::vec(-6i32..=6, FEATURE_DIM),
        flat in prop::collection::vec(prop::bool::weighted(0.2), FEATURE_DIM),
        copies in 0usize..200,
    ) {
        let mut draw = Draw::new(seed);
        let weigh = |row: [f32; ROW_STRIDE]| -> [f32; ROW_STRIDE] {
            std::array::from_fn(|i| match i {
                FEATURE_DIM => row[i],
                i if flat[i] => 0.0,
                i => row[i] * 10f32.powi(exponents[i]),
            })
        };
        let mut rows: Rows = draw.rows(count, 0.0).into_iter().map(weigh).collect();
        for _ in 0..copies {
            let (from, to) = (draw.below(count), draw.below(count));
            rows[to] = rows[from];
        }
        let mut queries: Rows = draw.rows(8, 1.0).into_iter().map(weigh).collect();
        queries.extend((0..4).map(|_| rows[draw.below(count)]));
        queries.extend(draw.rows(2, 1.0));
        same_as_twin(&rows, &queries);
    }
}
