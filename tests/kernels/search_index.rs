//! The four kernels of the search by the index, each against its twin on the twin's inputs.
//! Bars: `search_seed` may prefer another group where two bounds are equal but for rounding, and its
//! row is the nearest of that group all the same; `search_prune` may differ at leaves whose bound is
//! the limit but for rounding; `search_leaves` finds the twin's candidates, and `search_argmin` gives the
//! twin's bits. Distances have eight roundings: adapters may or may not fuse products into sums.

use crate::checked;
use crate::inputs::{Draw, POISON, POISON_WHOLE, SIZES, close, gpu};
use bytemuck::cast_slice;
use footwork::gpu::{Buffer, shader};
use footwork::kernels::search::search_index::{PROJECTION_LEN, GROUP, LANES};
use footwork::kernels::search::search_exact::squared;
use footwork::kernels::search::{search_leaves, search_seed, search_argmin, search_prune};
use footwork::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE, TRAJECTORY_DIM};
use footwork::matching::{Index, MEMORY, Packed};

const ROUNDING: f32 = 4.0 * f32::EPSILON;

struct Case {
    packed: Packed,
    shown: Vec<u32>,
    queries: Vec<[f32; ROW_STRIDE]>,
}

/// What the kernels hand on.
#[derive(Clone)]
struct Known {
    asked: Vec<f32>,
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
            packed: Packed::of(&Index::build(&frames, &candidates, memory)),
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
            asked: vec![POISON; PROJECTION_LEN * self.count()],
            distance: vec![POISON; lanes],
            candidates: vec![POISON_WHOLE; lanes],
        }
    }

    fn near(&self) -> search_seed::Params {
        search_seed::Params {
            count: self.count() as u32,
            groups: self.packed.groups,
            frames: self.packed.frames,
            step: self.packed.step,
            max_norm: self.packed.max_norm,
        }
    }

    fn reach(&self) -> search_prune::Params {
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

    fn near_twin(&self) -> Known {
        let mut known = self.poison();
        search_seed::twin(
            &self.packed.rows,
            self.boxes(),
            &self.packed.codes,
            &self.shown,
            &self.queries,
            &mut known.asked,
            &mut known.distance,
            &mut known.candidates,
            &self.near(),
        );
        known
    }

    fn near_agrees(&self, twin: &Known, got: &Known) {
        let count = self.count();
        close("asked", &got.asked, &twin.asked, |i| match i / count {
            axis if axis < TRAJECTORY_DIM => twin.asked[12 * count + i % count],
            _ => 1e-5 * twin.asked[i],
        });
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

    fn near_shader_agrees(&self, twin: &Known) {
        let gpu = gpu();
        let known = self.poison();
        let asked = Buffer::from_slice(&gpu, &known.asked);
        let distance = Buffer::from_slice(&gpu, &known.distance);
        let candidates = Buffer::from_slice(&gpu, &known.candidates);
        search_seed::launch(
            &gpu,
            &Buffer::from_slice(&gpu, self.packed.rows.as_flattened()),
            &Buffer::from_slice(&gpu, self.boxes().as_flattened()),
            &self.codes(&gpu),
            &Buffer::from_slice(&gpu, &self.shown),
            &Buffer::from_slice(&gpu, self.queries.as_flattened()),
            &asked,
            &distance,
            &candidates,
            &self.near(),
        );
        let got = Known {
            asked: asked.read(&gpu).expect("numbers"),
            distance: distance.read(&gpu).expect("distances"),
            candidates: candidates.read(&gpu).expect("candidates"),
        };
        self.near_agrees(twin, &got);
        let buffers: [&[u8]; 8] = [
            cast_slice(&self.packed.rows),
            cast_slice(self.boxes()),
            &self.packed.codes,
            cast_slice(&self.shown),
            cast_slice(&self.queries),
            cast_slice(&known.asked),
            cast_slice(&known.distance),
            cast_slice(&known.candidates),
        ];
        let groups = [self.count().div_ceil(32) as u32, 1, 1];
        let checked = checked::run(&shader::SEARCH_SEED, groups, &buffers, &self.near());
        let got = Known {
            asked: checked.of(5),
            distance: checked.of(6),
            candidates: checked.of(7),
        };
        self.near_agrees(twin, &got);
    }

    fn codes(&self, gpu: &footwork::gpu::Gpu) -> Buffer<u32> {
        Buffer::from_slice(gpu, &bytemuck::pod_collect_to_vec(&self.packed.codes))
    }

    fn reach_twin(&self, known: &Known) -> Vec<u32> {
        let mut reach = vec![POISON_WHOLE; self.words() * self.count()];
        search_prune::twin(
            self.boxes(),
            &self.packed.codes,
            &self.shown,
            &known.asked,
            &known.distance,
            &mut reach,
            &self.reach(),
        );
        reach
    }

    /// All but one leaf in ten thousand, which may lie at the limit.
    fn reach_agrees(&self, twin: &[u32], got: &[u32]) {
        let differ = twin.iter().zip(got).map(|(t, g)| (t ^ g).count_ones());
        let (differ, all) = (differ.sum::<u32>(), self.leaves() * self.count());
        assert!(differ as usize <= all / 10_000, "{differ} of {all}");
    }

    fn reach_shader_agrees(&self, known: &Known, twin: &[u32]) {
        let gpu = gpu();
        let poison = vec![POISON_WHOLE; twin.len()];
        let reach = Buffer::from_slice(&gpu, &poison);
        search_prune::launch(
            &gpu,
            &Buffer::from_slice(&gpu, self.boxes().as_flattened()),
            &self.codes(&gpu),
            &Buffer::from_slice(&gpu, &self.shown),
            &Buffer::from_slice(&gpu, &known.asked),
            &Buffer::from_slice(&gpu, &known.distance),
            &reach,
            &self.reach(),
        );
        self.reach_agrees(twin, &reach.read(&gpu).expect("bits"));
        let buffers: [&[u8]; 6] = [
            cast_slice(self.boxes()),
            &self.packed.codes,
            cast_slice(&self.shown),
            cast_slice(&known.asked),
            cast_slice(&known.distance),
            cast_slice(&poison),
        ];
        let runs = self.leaves().div_ceil(64) as u32;
        let groups = [self.count().div_ceil(128) as u32, runs, 1];
        let checked = checked::run(&shader::SEARCH_PRUNE, groups, &buffers, &self.reach());
        self.reach_agrees(twin, &checked.of::<u32>(5));
    }

    fn leaves_twin(&self, known: &mut Known, reach: &[u32]) {
        search_leaves::twin(
            &self.packed.rows,
            &self.packed.coarse,
            &self.queries,
            &known.asked,
            reach,
            &mut known.distance,
            &mut known.candidates,
            &self.leaf(),
        );
    }

    fn leaves_shader_agrees(&self, known: &Known, reach: &[u32], twin: &Known) {
        let gpu = gpu();
        let coarse = bytemuck::pod_collect_to_vec(&self.packed.coarse);
        let distance = Buffer::from_slice(&gpu, &known.distance);
        let candidates = Buffer::from_slice(&gpu, &known.candidates);
        search_leaves::launch(
            &gpu,
            &Buffer::from_slice(&gpu, self.packed.rows.as_flattened()),
            &Buffer::from_slice(&gpu, &coarse),
            &Buffer::from_slice(&gpu, self.queries.as_flattened()),
            &Buffer::from_slice(&gpu, &known.asked),
            &Buffer::from_slice(&gpu, reach),
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
            cast_slice(&self.packed.coarse),
            cast_slice(&self.queries),
            cast_slice(&known.asked),
            cast_slice(reach),
            cast_slice(&known.distance),
            cast_slice(&known.candidates),
        ];
        let groups = [(LANES * self.count()).div_ceil(64) as u32, 1, 1];
        let checked = checked::run(&shader::SEARCH_LEAVES, groups, &buffers, &self.leaf());
        close(&checked.of(5));
        assert_eq!(checked.of::<u32>(6), twin.candidates);
    }

    fn pick_agrees(&self, known: &Known) {
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
        for (rows, memory) in [(1, MEMORY), (300, MEMORY), (3000, 0), (9000, MEMORY)] {
            let case = Case::new(count, rows, memory, seed);
            let first = case.near_twin();
            case.near_shader_agrees(&first);
            let reach = case.reach_twin(&first);
            case.reach_shader_agrees(&first, &reach);
            let mut last = first.clone();
            case.leaves_twin(&mut last, &reach);
            case.leaves_shader_agrees(&first, &reach, &last);
            case.pick_agrees(&last);
        }
    }
}

/// Bounds never exclude the nearest row: what the twins find together is what comparing all finds.
#[test]
fn the_twins_together_find_the_nearest() {
    let case = Case::new(500, 9000, MEMORY, 9);
    let mut known = case.near_twin();
    let reach = case.reach_twin(&known);
    case.leaves_twin(&mut known, &reach);
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
    let within: u32 = reach.iter().map(|word| word.count_ones()).sum();
    assert!((within as usize) < case.leaves() * case.count());
}
