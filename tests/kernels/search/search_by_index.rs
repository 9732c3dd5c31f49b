//! The four kernels of the search by the index, each against its twin on the twin's inputs.
//! Bars: `search_seed` may prefer another group where two bounds are equal but for rounding, and its
//! row is the nearest of that group all the same; `search_prune` may differ at leaves whose bound is
//! the limit but for rounding; `search_leaves` finds the twin's candidates, and `search_argmin` gives the
//! twin's bits. Distances have eight roundings: adapters may or may not fuse products into sums.

use crate::inputs::{Draw, SIZES, close};
use footwork::kernels::search::search_exact::squared;
use footwork::kernels::search::search_index::{GROUP, LANES, PROJECTION_LEN};
use footwork::kernels::search::{search_argmin, search_leaves, search_prune, search_seed};
use footwork::matching::gpu::packed_index::PackedIndex;
use footwork::matching::{DEFAULT_TABLE_BYTES, Index};
use footwork::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE, TRAJECTORY_DIM};

const ROUNDING: f32 = 4.0 * f32::EPSILON;

struct Case {
    packed: PackedIndex,
    shown: Vec<u32>,
    queries: Vec<[f32; ROW_STRIDE]>,
}

/// What the kernels hand on.
#[derive(Clone)]
struct Known {
    query_projection: Vec<f32>,
    distance: Vec<f32>,
    candidates: Vec<u32>,
}

impl Case {
    /// Poses are rows' own, trajectories others' with noise.
    fn new(count: usize, rows: usize, memory: usize, seed: u32) -> Self {
        let mut draw = Draw::new(seed);
        let frames = draw.rows(rows, 0.0);
        let candidates: Vec<u32> = (0..rows as u32).collect();
        let shown: Vec<u32> = (0..count).map(|_| draw.below(rows) as u32).collect();
        let query = |&frame: &u32| {
            let future = frames[draw.below(rows)];
            let noise = 0.3 * draw.normal();
            std::array::from_fn(|d| match d {
                0..POSE_DIM => frames[frame as usize][d],
                POSE_DIM..FEATURE_DIM => future[d] + noise,
                _ => 1.0,
            })
        };
        Case {
            queries: shown.iter().map(query).collect(),
            packed: PackedIndex::of(&Index::build(&frames, &candidates, memory)),
            shown,
        }
    }

    fn count(&self) -> usize {
        self.queries.len()
    }

    fn leaves(&self) -> usize {
        self.packed.groups as usize * GROUP
    }

    fn words(&self) -> usize {
        self.leaves().div_ceil(32)
    }

    fn seed(&self) -> search_seed::Params {
        search_seed::Params {
            count: self.count() as u32,
            groups: self.packed.groups,
            frames: self.packed.frames,
            step: self.packed.step,
            max_norm: self.packed.max_norm,
        }
    }

    fn prune(&self) -> search_prune::Params {
        search_prune::Params {
            count: self.count() as u32,
            groups: self.packed.groups,
            first: 0,
            last: self.leaves() as u32,
            run: 64,
            frames: self.packed.frames,
            leaf_codes: self.packed.leaf_codes,
            step: self.packed.step,
        }
    }

    fn leaf(&self) -> search_leaves::Params {
        search_leaves::Params {
            count: self.count() as u32,
            first: 0,
            last: self.leaves() as u32,
            range: self.packed.range,
            quantisation_error: self.packed.quantisation_error,
        }
    }

    /// What `search_seed` makes of the queries, by the twin.
    fn seed_agrees(&self) -> Known {
        let (packed, count) = (&self.packed, self.count());
        let lanes = LANES * count;
        let groups = [count.div_ceil(32) as u32, 1, 1];
        let forms = forms!(
            search_seed, SEARCH_SEED, groups, self.seed();
            packed.rows, packed.boxes, packed.distance_codes, self.shown, self.queries,
            out PROJECTION_LEN * count, out lanes, out lanes
        );
        let forms = forms.map(|(query_projection, distance, candidates)| Known {
            query_projection,
            distance,
            candidates,
        });
        for (_, got) in forms.shaders() {
            self.seed_is_right(&forms.twin, got);
        }
        forms.twin
    }

    fn seed_is_right(&self, twin: &Known, got: &Known) {
        let count = self.count();
        close(
            "query_projection",
            &got.query_projection,
            &twin.query_projection,
            |i| match i / count {
                axis if axis < TRAJECTORY_DIM => twin.query_projection[12 * count + i % count],
                _ => 1e-5 * twin.query_projection[i],
            },
        );
        let mut others = 0;
        for at in 0..count {
            let candidate = got.candidates[at];
            let of = |row: &&[f32; ROW_STRIDE]| row[FEATURE_DIM] as u32 == candidate;
            let row = self.packed.rows.iter().find(of).expect("a candidate");
            let near = squared(row, &self.queries[at]);
            for lane in (at..LANES * count).step_by(count) {
                assert!((got.distance[lane] - near).abs() <= ROUNDING * near);
                assert_eq!(got.candidates[lane], candidate);
            }
            others += usize::from(candidate != twin.candidates[at]);
        }
        assert!(others * 100 <= count, "{others} of {count}");
    }

    /// The leaves that `search_prune` leaves, by the twin. All but one in ten thousand are the same, which
    /// may lie at the limit.
    fn prune_agrees(&self, known: &Known) -> Vec<u32> {
        let (packed, all) = (&self.packed, self.leaves() * self.count());
        let runs = self.leaves().div_ceil(64) as u32;
        let groups = [self.count().div_ceil(128) as u32, runs, 1];
        let forms = forms!(
            search_prune, SEARCH_PRUNE, groups, self.prune();
            packed.boxes, packed.distance_codes, self.shown, known.query_projection, known.distance,
            out self.words() * self.count()
        );
        for (form, got) in forms.shaders() {
            let differ = forms
                .twin
                .iter()
                .zip(got)
                .map(|(t, g)| (t ^ g).count_ones());
            let differ = differ.sum::<u32>();
            assert!(differ as usize <= all / 10_000, "{form}: {differ} of {all}");
        }
        forms.twin
    }

    /// What `search_leaves` makes of what is known, by the twin.
    fn leaves_agree(&self, known: &Known, leaf_mask: &[u32]) -> Known {
        let packed = &self.packed;
        let forms = forms!(
            search_leaves, SEARCH_LEAVES, LANES * self.count(), self.leaf();
            packed.rows, packed.quantised_rows, self.queries, known.query_projection, leaf_mask,
            mut known.distance, mut known.candidates
        );
        let (distance, candidates) = &forms.twin;
        for (form, got) in forms.shaders() {
            close(form, &got.0, distance, |i| ROUNDING * distance[i]);
            assert_eq!(got.1, *candidates, "{form}");
        }
        let (distance, candidates) = forms.twin;
        Known {
            query_projection: known.query_projection.clone(),
            distance,
            candidates,
        }
    }

    fn argmin_agrees(&self, known: &Known) {
        let count = self.count();
        let params = search_argmin::Params {
            count: count as u32,
        };
        let forms = forms!(
            search_argmin, SEARCH_ARGMIN, count, params; known.distance, known.candidates, out count
        );
        for (form, got) in forms.shaders() {
            assert_eq!(*got, forms.twin, "{form}");
        }
    }
}

#[test]
fn each_agrees_with_its_twin() {
    for (seed, count) in (0..).zip(SIZES) {
        for (rows, memory) in [
            (1, DEFAULT_TABLE_BYTES),
            (300, DEFAULT_TABLE_BYTES),
            (3000, 0),
            (9000, DEFAULT_TABLE_BYTES),
        ] {
            let case = Case::new(count, rows, memory, seed);
            let first = case.seed_agrees();
            let leaf_mask = case.prune_agrees(&first);
            let last = case.leaves_agree(&first, &leaf_mask);
            case.argmin_agrees(&last);
        }
    }
}

/// Bounds never exclude the nearest row: what the twins find together is what comparing all finds.
#[test]
fn the_twins_together_find_the_nearest() {
    let case = Case::new(500, 9000, DEFAULT_TABLE_BYTES, 9);
    let known = case.seed_agrees();
    let leaf_mask = case.prune_agrees(&known);
    let known = case.leaves_agree(&known, &leaf_mask);
    for (at, query) in case.queries.iter().enumerate() {
        let each = case.packed.rows.iter();
        let of = |row: &[f32; ROW_STRIDE]| (squared(row, query), row[FEATURE_DIM] as u32);
        let best = each
            .map(of)
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let lanes = (at..known.distance.len()).step_by(case.count());
        let found = lanes
            .map(|lane| (known.distance[lane], known.candidates[lane]))
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        assert_eq!(found, best);
    }
    let within: u32 = leaf_mask.iter().map(|word| word.count_ones()).sum();
    assert!((within as usize) < case.leaves() * case.count());
}
