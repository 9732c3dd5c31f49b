//! The four kernels of the search by the index, each against its twin on the twin's inputs.
//! Bars: `search_seed` may prefer another group where two bounds are equal but for rounding, and its
//! row is the nearest of that group all the same; `search_prune` may differ at leaves whose bound is
//! the limit but for rounding; `search_leaves` finds the twin's candidates, and `search_argmin` gives the
//! twin's bits. Distances have eight roundings: adapters may or may not fuse products into sums.

use crate::checked;
use crate::inputs::{Draw, POISON, POISON_WHOLE, SIZES, close, gpu};
use bytemuck::cast_slice;
use footwork::gpu::{Buffer, shader};
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

    fn poison(&self) -> Known {
        let lanes = LANES * self.count();
        Known {
            query_projection: vec![POISON; PROJECTION_LEN * self.count()],
            distance: vec![POISON; lanes],
            candidates: vec![POISON_WHOLE; lanes],
        }
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

    fn boxes(&self) -> &[[f32; TRAJECTORY_DIM]] {
        &self.packed.boxes
    }

    fn seed_twin(&self) -> Known {
        let mut known = self.poison();
        search_seed::twin(
            &self.packed.rows,
            self.boxes(),
            &self.packed.distance_codes,
            &self.shown,
            &self.queries,
            &mut known.query_projection,
            &mut known.distance,
            &mut known.candidates,
            &self.seed(),
        );
        known
    }

    fn seed_agrees(&self, twin: &Known, got: &Known) {
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

    fn seed_shader_agrees(&self, twin: &Known) {
        let gpu = gpu();
        let known = self.poison();
        let query_projection = Buffer::from_slice(&gpu, &known.query_projection);
        let distance = Buffer::from_slice(&gpu, &known.distance);
        let candidates = Buffer::from_slice(&gpu, &known.candidates);
        search_seed::launch(
            &gpu,
            &Buffer::from_slice(&gpu, self.packed.rows.as_flattened()),
            &Buffer::from_slice(&gpu, self.boxes().as_flattened()),
            &self.codes(&gpu),
            &Buffer::from_slice(&gpu, &self.shown),
            &Buffer::from_slice(&gpu, self.queries.as_flattened()),
            &query_projection,
            &distance,
            &candidates,
            &self.seed(),
        );
        let got = Known {
            query_projection: query_projection.read(&gpu).expect("numbers"),
            distance: distance.read(&gpu).expect("distances"),
            candidates: candidates.read(&gpu).expect("candidates"),
        };
        self.seed_agrees(twin, &got);
        let buffers: [&[u8]; 8] = [
            cast_slice(&self.packed.rows),
            cast_slice(self.boxes()),
            &self.packed.distance_codes,
            cast_slice(&self.shown),
            cast_slice(&self.queries),
            cast_slice(&known.query_projection),
            cast_slice(&known.distance),
            cast_slice(&known.candidates),
        ];
        let groups = [self.count().div_ceil(32) as u32, 1, 1];
        let checked = checked::run(&shader::SEARCH_SEED, groups, &buffers, &self.seed());
        let got = Known {
            query_projection: checked.of(5),
            distance: checked.of(6),
            candidates: checked.of(7),
        };
        self.seed_agrees(twin, &got);
    }

    fn codes(&self, gpu: &footwork::gpu::Gpu) -> Buffer<u32> {
        Buffer::from_slice(
            gpu,
            &bytemuck::pod_collect_to_vec(&self.packed.distance_codes),
        )
    }

    fn prune_twin(&self, known: &Known) -> Vec<u32> {
        let mut leaf_mask = vec![POISON_WHOLE; self.words() * self.count()];
        search_prune::twin(
            self.boxes(),
            &self.packed.distance_codes,
            &self.shown,
            &known.query_projection,
            &known.distance,
            &mut leaf_mask,
            &self.prune(),
        );
        leaf_mask
    }

    /// All but one leaf in ten thousand, which may lie at the limit.
    fn prune_agrees(&self, twin: &[u32], got: &[u32]) {
        let differ = twin.iter().zip(got).map(|(t, g)| (t ^ g).count_ones());
        let (differ, all) = (differ.sum::<u32>(), self.leaves() * self.count());
        assert!(differ as usize <= all / 10_000, "{differ} of {all}");
    }

    fn prune_shader_agrees(&self, known: &Known, twin: &[u32]) {
        let gpu = gpu();
        let poison = vec![POISON_WHOLE; twin.len()];
        let leaf_mask = Buffer::from_slice(&gpu, &poison);
        search_prune::launch(
            &gpu,
            &Buffer::from_slice(&gpu, self.boxes().as_flattened()),
            &self.codes(&gpu),
            &Buffer::from_slice(&gpu, &self.shown),
            &Buffer::from_slice(&gpu, &known.query_projection),
            &Buffer::from_slice(&gpu, &known.distance),
            &leaf_mask,
            &self.prune(),
        );
        self.prune_agrees(twin, &leaf_mask.read(&gpu).expect("bits"));
        let buffers: [&[u8]; 6] = [
            cast_slice(self.boxes()),
            &self.packed.distance_codes,
            cast_slice(&self.shown),
            cast_slice(&known.query_projection),
            cast_slice(&known.distance),
            cast_slice(&poison),
        ];
        let runs = self.leaves().div_ceil(64) as u32;
        let groups = [self.count().div_ceil(128) as u32, runs, 1];
        let checked = checked::run(&shader::SEARCH_PRUNE, groups, &buffers, &self.prune());
        self.prune_agrees(twin, &checked.of::<u32>(5));
    }

    fn leaves_twin(&self, known: &mut Known, leaf_mask: &[u32]) {
        search_leaves::twin(
            &self.packed.rows,
            &self.packed.quantised_rows,
            &self.queries,
            &known.query_projection,
            leaf_mask,
            &mut known.distance,
            &mut known.candidates,
            &self.leaf(),
        );
    }

    fn leaves_shader_agrees(&self, known: &Known, leaf_mask: &[u32], twin: &Known) {
        let gpu = gpu();
        let quantised_rows = bytemuck::pod_collect_to_vec(&self.packed.quantised_rows);
        let distance = Buffer::from_slice(&gpu, &known.distance);
        let candidates = Buffer::from_slice(&gpu, &known.candidates);
        search_leaves::launch(
            &gpu,
            &Buffer::from_slice(&gpu, self.packed.rows.as_flattened()),
            &Buffer::from_slice(&gpu, &quantised_rows),
            &Buffer::from_slice(&gpu, self.queries.as_flattened()),
            &Buffer::from_slice(&gpu, &known.query_projection),
            &Buffer::from_slice(&gpu, leaf_mask),
            &distance,
            &candidates,
            &self.leaf(),
        );
        let close = |got: &[f32]| {
            close("distance", got, &twin.distance, |i| {
                ROUNDING * twin.distance[i]
            });
        };
        close(&distance.read(&gpu).expect("distances"));
        assert_eq!(candidates.read(&gpu).expect("candidates"), twin.candidates);
        let buffers: [&[u8]; 7] = [
            cast_slice(&self.packed.rows),
            cast_slice(&self.packed.quantised_rows),
            cast_slice(&self.queries),
            cast_slice(&known.query_projection),
            cast_slice(leaf_mask),
            cast_slice(&known.distance),
            cast_slice(&known.candidates),
        ];
        let groups = [(LANES * self.count()).div_ceil(64) as u32, 1, 1];
        let checked = checked::run(&shader::SEARCH_LEAVES, groups, &buffers, &self.leaf());
        close(&checked.of(5));
        assert_eq!(checked.of::<u32>(6), twin.candidates);
    }

    fn argmin_agrees(&self, known: &Known) {
        let gpu = gpu();
        let count = self.count();
        let params = search_argmin::Params {
            count: count as u32,
        };
        // Some too many: they must stay untouched.
        let poison = vec![POISON_WHOLE; count + 9];
        let mut twin = poison.clone();
        search_argmin::twin(&known.distance, &known.candidates, &mut twin, &params);
        let matched = Buffer::from_slice(&gpu, &poison);
        search_argmin::launch(
            &gpu,
            &Buffer::from_slice(&gpu, &known.distance),
            &Buffer::from_slice(&gpu, &known.candidates),
            &matched,
            &params,
        );
        assert_eq!(matched.read(&gpu).expect("matches"), twin);
        let buffers: [&[u8]; 3] = [
            cast_slice(&known.distance),
            cast_slice(&known.candidates),
            cast_slice(&poison),
        ];
        let groups = [count.div_ceil(64) as u32, 1, 1];
        let checked = checked::run(&shader::SEARCH_ARGMIN, groups, &buffers, &params);
        assert_eq!(checked.of::<u32>(2), twin);
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
            let first = case.seed_twin();
            case.seed_shader_agrees(&first);
            let leaf_mask = case.prune_twin(&first);
            case.prune_shader_agrees(&first, &leaf_mask);
            let mut last = first.clone();
            case.leaves_twin(&mut last, &leaf_mask);
            case.leaves_shader_agrees(&first, &leaf_mask, &last);
            case.argmin_agrees(&last);
        }
    }
}

/// Bounds never exclude the nearest row: what the twins find together is what comparing all finds.
#[test]
fn the_twins_together_find_the_nearest() {
    let case = Case::new(500, 9000, DEFAULT_TABLE_BYTES, 9);
    let mut known = case.seed_twin();
    let leaf_mask = case.prune_twin(&known);
    case.leaves_twin(&mut known, &leaf_mask);
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
