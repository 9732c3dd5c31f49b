//! The search of a batch of queries, region after region of the tree, and in each group after group: what
//! has been fetched from memory serves them all. A step is made for all queries before the next one
//! begins, so that the processor need not wait for one query's bounds to know what to do for another.

use super::index::{Index, trajectory_norm};
use super::pose_distance_table::PoseCodes;
use super::quantised_boxes::{GridPoint, LANES, OutOfGrid, POSE_PAIRS, TRAJECTORY_PAIRS};
use super::tree::{LeafRows, TrajectoryBoxes};
use crate::motion::features::{FEATURE_DIM, ROW_STRIDE, TRAJECTORY_DIM};
use multiversion::multiversion;
use rayon::prelude::*;

/// Queries of a task of the thread pool, at least and at most: what one of them has fetched from memory
/// serves the others. In between, so many that each has to fetch [`FETCHED_BYTES`].
const TASK_QUERIES: [usize; 2] = [16, 4096];
const FETCHED_BYTES: usize = 1 << 15;
/// The nearest regions of a query, and the nearest of their groups, whose nearest leaf is compared before
/// all else: the winner lets most others be skipped.
const SEEDS: usize = 3;

/// The nearest row and its squared distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Index of the row among the candidates.
    pub index: u32,
    /// Squared distance, normalised.
    pub distance: f32,
}

impl Nearest {
    /// Row 0 stands when nothing is nearer than infinity, as with a query that is not a number.
    const NONE: Nearest = Nearest {
        index: 0,
        distance: f32::INFINITY,
    };
}

/// The memory of a search of one query at a time, which a next one uses again.
#[derive(Clone, Debug, Default)]
pub struct SearchScratch {
    /// Codes of the regions.
    by_region: Vec<u8>,
    /// Bounds of the regions.
    bounds: Vec<f32>,
}

impl Index {
    /// Nearest candidate of one query, whose pose half is that of `frame`; of equals the lowest.
    pub fn nearest(&self, frame: u32, query: &[f32; ROW_STRIDE]) -> Nearest {
        self.nearest_with(frame, query, &mut SearchScratch::default())
    }

    /// [`Index::nearest`] in memory that is there already: from the second search on nothing is allocated.
    pub fn nearest_with(
        &self,
        frame: u32,
        query: &[f32; ROW_STRIDE],
        scratch: &mut SearchScratch,
    ) -> Nearest {
        search_one(self, frame, query, scratch)
    }

    /// Nearest candidate of every query, on all cores.
    pub fn nearest_all(&self, frames: &[u32], queries: &[[f32; ROW_STRIDE]], found: &mut [u32]) {
        // As many tasks for every thread, lest one wait for another's last.
        let threads = rayon::current_num_threads();
        let enough = (self.tree.bytes() / FETCHED_BYTES).clamp(TASK_QUERIES[0], TASK_QUERIES[1]);
        let rounds = queries.len().div_ceil(threads * enough).max(1);
        let task = queries
            .len()
            .div_ceil(threads * rounds)
            .max(TASK_QUERIES[0]);
        frames
            .par_chunks(task)
            .zip(queries.par_chunks(task))
            .zip(found.par_chunks_mut(task))
            .for_each(|((frames, queries), found)| {
                if let ([frame], [query]) = (frames, queries) {
                    found[0] = self.nearest(*frame, query).index;
                    return;
                }
                let mut nearest = vec![Nearest::NONE; found.len()];
                search(self, frames, queries, &mut nearest);
                for (found, nearest) in found.iter_mut().zip(nearest) {
                    *found = nearest.index;
                }
            });
    }
}

/// A query in the forms that the bounds need, and its best row so far. In this order what a step needs
/// is stored in one or two cache lines.
#[repr(C, align(64))]
struct QueryState<'a> {
    query: [f32; ROW_STRIDE],
    /// Rounding may lengthen a bound (no square) by this and by [`RELATIVE`]: a rotated number
    /// and its difference to another have errors of a few 2^-24 of the two vectors' lengths.
    slack: f32,
    best: Best,
    /// Its trajectory and its pose on the grids of the leaves' boxes.
    quantised: (GridPoint<TRAJECTORY_PAIRS>, GridPoint<POSE_PAIRS>),
    /// Whether `out_of_grid` is not zero, as with few: the others need not fetch that.
    is_outside: bool,
    /// Along the principal axes.
    trajectory: [f32; TRAJECTORY_DIM],
    poses: PoseCodes<'a>,
    out_of_grid: OutOfGrid<TRAJECTORY_PAIRS>,
}

const RELATIVE: f32 = 1.0 + 1e-5;
const SLACK: f32 = 4e-6;

/// The best row so far.
struct Best {
    nearest: Nearest,
    /// Squared bound beyond which nothing is nearer, or as near.
    limit: f32,
}

impl Best {
    const NONE: Best = Best {
        nearest: Nearest::NONE,
        limit: f32::INFINITY,
    };

    #[inline(always)]
    fn offer(&mut self, id: u32, distance: f32, slack: f32) {
        let best = self.nearest;
        if distance < best.distance || (distance == best.distance && id < best.index) {
            self.nearest = Nearest {
                index: id,
                distance,
            };
            let length = distance.sqrt() * RELATIVE + slack;
            self.limit = length * length;
        }
    }
}

impl<'a> QueryState<'a> {
    #[inline(always)]
    fn new(index: &Index, query: &[f32; ROW_STRIDE], poses: PoseCodes<'a>) -> Self {
        let trajectory = index.axes.project(query);
        let out_of_grid = index.tree.grid.out_of_grid(&trajectory);
        QueryState {
            query: *query,
            slack: SLACK * (index.max_norm + trajectory_norm(query)),
            best: Best::NONE,
            quantised: (
                index.tree.grid.quantise(&trajectory),
                index.poses.grid.quantise(query),
            ),
            is_outside: out_of_grid.squared > 0.0,
            trajectory,
            poses,
            out_of_grid,
        }
    }
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
fn search(index: &Index, frames: &[u32], queries: &[[f32; ROW_STRIDE]], found: &mut [Nearest]) {
    let poses = index.poses.gather(frames);
    let queries = queries.iter().enumerate();
    let states = queries.map(|(at, query)| QueryState::new(index, query, poses.row(at)));
    let mut states: Vec<QueryState> = states.collect();
    let mut bounds = Vec::new();
    let mut nearest = vec![LeastBounds::NONE; states.len()];
    region_bounds(index, &states, &mut bounds, &mut nearest);
    for (state, nearest) in states.iter_mut().zip(nearest) {
        seed(index, nearest, state);
    }
    let regions = bounds.chunks_exact(states.len());
    let regions = regions.take(index.tree.group_boxes.len()).enumerate();
    let mut steps = Steps::new(states.len());
    for (region, bounds) in regions {
        steps.groups(index, region, bounds, &states);
        for lane in 0..LANES {
            steps.leaves(index, region, lane, &mut states);
        }
    }
    for (found, state) in found.iter_mut().zip(states) {
        *found = state.best.nearest;
    }
}

/// A query alone has nothing to share, and each step would wait for the one before: region by region.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
fn search_one(
    index: &Index,
    frame: u32,
    query: &[f32; ROW_STRIDE],
    scratch: &mut SearchScratch,
) -> Nearest {
    let poses = index.poses.codes(frame, &mut scratch.by_region);
    let mut states = [QueryState::new(index, query, poses)];
    let mut nearest = [LeastBounds::NONE];
    region_bounds(index, &states, &mut scratch.bounds, &mut nearest);
    let ([state], [nearest]) = (&mut states, nearest);
    seed(index, nearest, state);
    let regions = scratch.bounds.iter().take(index.tree.group_boxes.len());
    for (region, &bound) in regions.enumerate() {
        search_region(index, region, bound, state);
    }
    state.best.nearest
}

/// Puts lower bounds of the squared distances to all regions, `[regions][queries]`, into `all`, and offers
/// each query the nearest regions.
#[inline(always)]
fn region_bounds(
    index: &Index,
    states: &[QueryState],
    all: &mut Vec<f32>,
    nearest: &mut [LeastBounds],
) {
    let count = states.len();
    all.clear();
    all.resize(index.tree.region_boxes.len() * LANES * count, 0.0);
    for (at, boxes) in index.tree.region_boxes.iter().enumerate() {
        let all = &mut all[at * LANES * count..][..LANES * count];
        for (i, (state, nearest)) in states.iter().zip(&mut *nearest).enumerate() {
            let poses = index.poses.squared_distances(state.poses.to_regions(at));
            let bounds = box_distances(boxes, &state.trajectory, poses);
            nearest.offer(&bounds, at * LANES);
            for (of_region, bound) in all.chunks_exact_mut(count).zip(bounds) {
                of_region[i] = bound;
            }
        }
    }
}

/// Compares the nearest leaf of each of the nearest groups of the nearest regions, for a first result.
#[inline(always)]
fn seed(index: &Index, regions: LeastBounds, state: &mut QueryState) {
    let mut nearest = LeastBounds::NONE;
    for region in regions.below(index.tree.group_boxes.len()) {
        nearest.offer(&group_bounds(index, region, state), region * LANES);
    }
    for group in nearest.below(index.tree.leaf_boxes.len()) {
        let bounds = leaf_bounds(index, group, state, state.poses.to_leaves(group));
        let lanes = LaneMask::of(&bounds, least(&bounds));
        compare(index, group, state, &bounds, lanes);
    }
}

#[inline(always)]
fn least(bounds: &[f32; LANES]) -> f32 {
    let mut least = f32::INFINITY;
    for &bound in bounds {
        least = if bound < least { bound } else { least };
    }
    least
}

/// Searches a region whose bound is known for a single query.
#[inline(always)]
fn search_region(index: &Index, region: usize, bound: f32, state: &mut QueryState) {
    if bound > state.best.limit {
        return;
    }
    let groups = group_bounds(index, region, state);
    for lane in LaneMask::of(&groups, state.best.limit).of_region(index, region) {
        if groups[lane] > state.best.limit {
            continue;
        }
        let group = region * LANES + lane;
        let bounds = leaf_bounds(index, group, state, state.poses.to_leaves(group));
        let within = LaneMask::of(&bounds, state.best.limit);
        compare(index, group, state, &bounds, within);
    }
}

/// Lower bounds of the squared distances to the groups of a region.
#[inline(always)]
fn group_bounds(index: &Index, region: usize, state: &QueryState) -> [f32; LANES] {
    let poses = index.poses.squared_distances(state.poses.to_groups(region));
    box_distances(&index.tree.group_boxes[region], &state.trajectory, poses)
}

/// Lower bounds of the squared distances to the leaves of a group, with the `codes` of their poses.
#[inline(always)]
fn leaf_bounds(
    index: &Index,
    group: usize,
    state: &QueryState,
    codes: [u8; LANES],
) -> [f32; LANES] {
    let (trajectory, pose) = &state.quantised;
    let (grid, boxes) = (&index.tree.grid, &index.tree.leaf_boxes[group]);
    // Apart, for almost all are on the grid, and that is less to do.
    let mut bounds = match state.is_outside {
        true => grid.squared_distances(boxes, trajectory, &state.out_of_grid),
        false => grid.squared_distances(boxes, trajectory, &OutOfGrid::NONE),
    };
    for (bound, known) in bounds.iter_mut().zip(index.poses.squared_distances(codes)) {
        *bound += known;
    }
    index.poses.raise_bounds(group, codes, pose, &mut bounds);
    bounds
}

/// A query for which a group has to be searched.
struct Pending {
    query: u32,
    /// The bound of the group.
    bound: f32,
    /// Pose codes of its leaves.
    codes: [u8; LANES],
}

/// A query, and its bounds of sixteen groups or leaves.
#[derive(Clone, Copy)]
struct Bounded {
    query: u32,
    bounds: [f32; LANES],
    within: LaneMask,
}

/// What a step leaves for the next one. Entries without effect are overwritten by the following ones,
/// without a branch: which ones they are cannot be predicted.
struct Steps {
    queries: Vec<u32>,
    bounded: Vec<Bounded>,
    /// By group of a region.
    pending: [Vec<Pending>; LANES],
}

impl Steps {
    fn new(count: usize) -> Self {
        let nothing = Bounded {
            query: 0,
            bounds: [0.0; LANES],
            within: LaneMask(0),
        };
        Steps {
            queries: vec![0; count],
            bounded: vec![nothing; count],
            pending: Default::default(),
        }
    }

    /// Finds the queries for which groups of a region, whose `bounds` are known, have to be searched.
    #[inline(always)]
    fn groups(&mut self, index: &Index, region: usize, bounds: &[f32], states: &[QueryState]) {
        let mut count = 0;
        for (i, (&bound, state)) in bounds.iter().zip(states).enumerate() {
            self.queries[count] = i as u32;
            // Not the other way round: a bound that is not a number skips nothing.
            count += usize::from(bound > state.best.limit) ^ 1;
        }
        for (&query, bounded) in self.queries[..count].iter().zip(&mut self.bounded) {
            let state = &states[query as usize];
            let bounds = group_bounds(index, region, state);
            *bounded = Bounded {
                query,
                bounds,
                within: LaneMask::of(&bounds, state.best.limit).of_region(index, region),
            };
        }
        for &Bounded {
            query,
            ref bounds,
            within,
        } in &self.bounded[..count]
        {
            let poses = states[query as usize].poses;
            for lane in within {
                self.pending[lane].push(Pending {
                    query,
                    bound: bounds[lane],
                    codes: poses.to_leaves(region * LANES + lane),
                });
            }
        }
    }

    /// Searches the leaves of a group for its pending queries.
    #[inline(always)]
    fn leaves(&mut self, index: &Index, region: usize, lane: usize, states: &mut [QueryState]) {
        let group = region * LANES + lane;
        let mut count = 0;
        for &Pending {
            query,
            bound,
            codes,
        } in &self.pending[lane]
        {
            let state = &states[query as usize];
            if bound > state.best.limit {
                continue;
            }
            let bounds = leaf_bounds(index, group, state, codes);
            let within = LaneMask::of(&bounds, state.best.limit);
            self.bounded[count] = Bounded {
                query,
                bounds,
                within,
            };
            count += usize::from(within.0 != 0);
        }
        self.pending[lane].clear();
        for &Bounded {
            query,
            ref bounds,
            within,
        } in &self.bounded[..count]
        {
            compare(index, group, &mut states[query as usize], bounds, within);
        }
    }
}

/// Offers the rows of those leaves of a group that are `within` the limit.
#[inline(always)]
fn compare(
    index: &Index,
    group: usize,
    state: &mut QueryState,
    bounds: &[f32; LANES],
    within: LaneMask,
) {
    for lane in within {
        // The best may have come nearer since.
        if bounds[lane] > state.best.limit {
            continue;
        }
        let leaf = group * LANES + lane;
        let distances = row_distances(&index.tree.leaves[leaf], &state.query);
        let mut nearer = false;
        for distance in distances {
            nearer |= distance <= state.best.nearest.distance;
        }
        if !nearer {
            continue;
        }
        for (&id, distance) in index.tree.ids[leaf].iter().zip(distances) {
            state.best.offer(id, distance, state.slack);
        }
    }
}

/// The lanes whose bounds are within a limit, a bit each: found without a branch for every lane.
#[derive(Clone, Copy)]
struct LaneMask(u32);

impl LaneMask {
    #[inline(always)]
    fn of(bounds: &[f32; LANES], limit: f32) -> Self {
        // Not the other way round: a bound that is not a number skips nothing.
        let within = bounds.map(|bound| u8::from(bound > limit) ^ 1);
        // Taken from memory: otherwise the compiler tests each lane alone.
        let bytes = u128::from_le_bytes(std::hint::black_box(within));
        // The factor moves the lowest bit of byte i to bit i of the highest byte.
        let bits = |bytes: u64| (bytes.wrapping_mul(0x0102_0408_1020_4080) >> 56) as u32;
        LaneMask(bits(bytes as u64) | bits((bytes >> 64) as u64) << 8)
    }

    /// Without those for which the last region has no groups.
    #[inline(always)]
    fn of_region(self, index: &Index, region: usize) -> Self {
        let groups = index.tree.leaf_boxes.len() - region * LANES;
        LaneMask(self.0 & ((1 << groups.min(LANES)) - 1))
    }
}

impl Iterator for LaneMask {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    }
}

/// The least bounds, rising, and the numbers of what has them.
#[derive(Clone, Copy)]
struct LeastBounds([(f32, u32); SEEDS]);

impl LeastBounds {
    const NONE: LeastBounds = LeastBounds([(f32::INFINITY, u32::MAX); SEEDS]);

    /// Takes in sixteen bounds, whose numbers count from `first`.
    #[inline(always)]
    fn offer(&mut self, bounds: &[f32; LANES], first: usize) {
        let mut nearer = false;
        for &bound in bounds {
            nearer |= bound < self.0[SEEDS - 1].0;
        }
        if !nearer {
            return;
        }
        for (lane, &bound) in bounds.iter().enumerate() {
            if bound < self.0[SEEDS - 1].0 {
                let at = self.0.iter().filter(|near| near.0 <= bound).count();
                self.0[at..].rotate_right(1);
                self.0[at] = (bound, (first + lane) as u32);
            }
        }
    }

    /// The numbers below `count`: padding is infinitely far away only from a query of numbers.
    #[inline(always)]
    fn below(self, count: usize) -> impl Iterator<Item = usize> {
        let numbers = self.0.into_iter().map(|near| near.1 as usize);
        numbers.filter(move |&number| number < count)
    }
}

/// Squared distances of a trajectory to sixteen boxes, on top of those of the poses.
#[inline(always)]
fn box_distances(
    boxes: &TrajectoryBoxes,
    trajectory: &[f32; TRAJECTORY_DIM],
    poses: [f32; LANES],
) -> [f32; LANES] {
    let mut sum = poses;
    for ((lows, highs), &value) in boxes.low.iter().zip(&boxes.high).zip(trajectory) {
        for ((sum, &low), &high) in sum.iter_mut().zip(lows).zip(highs) {
            let (below, above) = (low - value, value - high);
            let outside = if below > above { below } else { above };
            let outside = if outside > 0.0 { outside } else { 0.0 };
            *sum = outside.mul_add(outside, *sum);
        }
    }
    sum
}

/// Squared distances to sixteen rows, in the four interleaved sums of
/// [`squared`](crate::kernels::search::search_exact::squared).
#[inline(always)]
fn row_distances(LeafRows(rows): &LeafRows, query: &[f32; ROW_STRIDE]) -> [f32; LANES] {
    let (mut a, mut b, mut c, mut d) = ([0.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]);
    for at in (0..FEATURE_DIM).step_by(4) {
        add_squares(&rows[at], query[at], &mut a);
    }
    for at in (1..FEATURE_DIM).step_by(4) {
        add_squares(&rows[at], query[at], &mut b);
    }
    for at in (2..FEATURE_DIM).step_by(4) {
        add_squares(&rows[at], query[at], &mut c);
    }
    for at in (3..FEATURE_DIM).step_by(4) {
        add_squares(&rows[at], query[at], &mut d);
    }
    let mut joined = [0.0; LANES];
    for (lane, joined) in joined.iter_mut().enumerate() {
        *joined = (a[lane] + b[lane]) + (c[lane] + d[lane]);
    }
    joined
}

#[inline(always)]
fn add_squares(rows: &[f32; LANES], value: f32, sums: &mut [f32; LANES]) {
    for (sum, &row) in sums.iter_mut().zip(rows) {
        let difference = row - value;
        *sum = difference.mul_add(difference, *sum);
    }
}
