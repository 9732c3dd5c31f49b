//! The search of a batch of queries, region after region of the tree, and in each group after group: what
//! has been fetched from memory serves them all. A step is made for all queries before the next one
//! begins, so that the processor need not wait for one query's bounds to know what to do for another.

use super::quantised_boxes::{Beyond, POSE_PAIRS, Place, TRAJECTORY_PAIRS};
use super::pose_distance_table::Row;
use super::tree::{Boxes, LANES, Lanes};
use super::{Index, Nearest, length};
use crate::motion::database::ROW_STRIDE;
use crate::motion::features::{FEATURE_DIM, TRAJECTORY_DIM};
use multiversion::multiversion;

/// The nearest regions of a query, and of their groups, of which the nearest leaf is looked into before all
/// else: the winner lets most of that be skipped.
const FIRST: usize = 3;

/// What is asked, in the forms the bounds need, and the best answer so far. In this order what a step
/// needs lies in one or two lines of the cache.
#[repr(C, align(64))]
struct Asked<'a> {
    query: [f32; ROW_STRIDE],
    /// Rounding may lengthen a bound (no square) by this and by [`RELATIVE`]: a rotated number
    /// and its difference to another have errors of a few 2^-24 of the two vectors' lengths.
    slack: f32,
    best: Best,
    /// Where its trajectory and its pose lie among the boxes of the leaves.
    among: (Place<TRAJECTORY_PAIRS>, Place<POSE_PAIRS>),
    /// Whether there is something `beyond`, which few have: so those that do not need not fetch that.
    far: bool,
    trajectory: [f32; TRAJECTORY_DIM],
    poses: Row<'a>,
    beyond: Beyond<TRAJECTORY_PAIRS>,
}

const RELATIVE: f32 = 1.0 + 1e-5;
const SLACK: f32 = 4e-6;

/// The best so far.
struct Best {
    nearest: Nearest,
    /// What lies beyond this bound cannot be nearer, nor as near.
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

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
pub fn nearest(index: &Index, frames: &[u32], queries: &[[f32; ROW_STRIDE]], found: &mut [Nearest]) {
    let poses = index.poses.gather(frames);
    let asked = |(at, query)| {
        let trajectory = index.axes.turn(query);
        let beyond = index.tree.grid.beyond(&trajectory);
        Asked {
            query: *query,
            slack: SLACK * (index.longest + length(query)),
            best: Best::NONE,
            among: (
                index.tree.grid.place(&trajectory),
                index.poses.grid.place(query),
            ),
            far: beyond.square > 0.0,
            trajectory,
            poses: poses.row(at),
            beyond,
        }
    };
    let mut asked: Vec<Asked> = queries.iter().enumerate().map(asked).collect();
    let (bounds, near) = to_regions(index, &asked);
    for (asked, near) in asked.iter_mut().zip(near) {
        seed(index, near, asked);
    }
    let regions = bounds.chunks_exact(asked.len());
    let regions = regions.take(index.tree.outer.len()).enumerate();
    if let [asked] = &mut asked[..] {
        // Nothing to share, and each step would wait for the one before.
        regions.for_each(|(region, bounds)| alone(index, region, bounds[0], asked));
    } else {
        let mut steps = Steps::new(asked.len());
        for (region, bounds) in regions {
            steps.groups(index, region, bounds, &asked);
            for lane in 0..LANES {
                steps.leaves(index, region, lane, &mut asked);
            }
        }
    }
    for (found, asked) in found.iter_mut().zip(asked) {
        *found = asked.best.nearest;
    }
}

/// Squared distances to all regions at least, `[regions][queries]`, and the nearest regions of each query.
#[inline(always)]
fn to_regions(index: &Index, asked: &[Asked]) -> (Vec<f32>, Vec<Near>) {
    let count = asked.len();
    let mut near = vec![Near::NONE; count];
    let mut all = vec![0.0; index.tree.regions.len() * LANES * count];
    for (at, boxes) in index.tree.regions.iter().enumerate() {
        let all = &mut all[at * LANES * count..][..LANES * count];
        for (i, (asked, near)) in asked.iter().zip(&mut near).enumerate() {
            let known = index.poses.squares(asked.poses.to_regions(at));
            let bounds = outside(boxes, &asked.trajectory, known);
            near.offer(&bounds, at * LANES);
            for (of_region, bound) in all.chunks_exact_mut(count).zip(bounds) {
                of_region[i] = bound;
            }
        }
    }
    (all, near)
}

/// A first answer: of the nearest leaf of each of the nearest groups of the nearest regions.
#[inline(always)]
fn seed(index: &Index, regions: Near, asked: &mut Asked) {
    let mut near = Near::NONE;
    for region in regions.below(index.tree.outer.len()) {
        near.offer(&to_groups(index, region, asked), region * LANES);
    }
    for group in near.below(index.tree.inner.len()) {
        let bounds = to_leaves(index, group, asked, asked.poses.to_leaves(group));
        let nearest = Within::of(&bounds, least(&bounds));
        compare(index, group, asked, &bounds, nearest);
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

/// Lets a single query look into the groups of a region, of which a bound is known, and their leaves.
#[inline(always)]
fn alone(index: &Index, region: usize, bound: f32, asked: &mut Asked) {
    if bound > asked.best.limit {
        return;
    }
    let groups = to_groups(index, region, asked);
    for lane in Within::of(&groups, asked.best.limit).of_region(index, region) {
        if groups[lane] > asked.best.limit {
            continue;
        }
        let group = region * LANES + lane;
        let bounds = to_leaves(index, group, asked, asked.poses.to_leaves(group));
        let within = Within::of(&bounds, asked.best.limit);
        compare(index, group, asked, &bounds, within);
    }
}

/// Squared distances to the groups of a region at least.
#[inline(always)]
fn to_groups(index: &Index, region: usize, asked: &Asked) -> [f32; LANES] {
    let known = index.poses.squares(asked.poses.to_groups(region));
    outside(&index.tree.outer[region], &asked.trajectory, known)
}

/// Squared distances to the leaves of a group at least, of whose poses these are the codes.
#[inline(always)]
fn to_leaves(index: &Index, group: usize, asked: &Asked, codes: [u8; LANES]) -> [f32; LANES] {
    let (trajectory, pose) = &asked.among;
    let (grid, boxes) = (&index.tree.grid, &index.tree.inner[group]);
    // Apart, for almost all are near, and that is less to do.
    let mut bounds = match asked.far {
        true => grid.outside(boxes, trajectory, &asked.beyond),
        false => grid.outside(boxes, trajectory, &Beyond::NOTHING),
    };
    for (bound, known) in bounds.iter_mut().zip(index.poses.squares(codes)) {
        *bound += known;
    }
    index.poses.raise(group, codes, pose, &mut bounds);
    bounds
}

/// A query that has to look into a group.
struct Waiting {
    query: u32,
    /// Of the group.
    bound: f32,
    /// Of its leaves.
    codes: [u8; LANES],
}

/// A query, and bounds of sixteen groups or leaves.
#[derive(Clone, Copy)]
struct Bounded {
    query: u32,
    bounds: [f32; LANES],
    within: Within,
}

/// What a step leaves for the next one. What comes to nothing is overwritten by what follows, without a
/// branch: which ones do cannot be foreseen.
struct Steps {
    queries: Vec<u32>,
    bounded: Vec<Bounded>,
    /// By group of a region.
    waiting: [Vec<Waiting>; LANES],
}

impl Steps {
    fn new(count: usize) -> Self {
        let nothing = Bounded {
            query: 0,
            bounds: [0.0; LANES],
            within: Within(0),
        };
        Steps {
            queries: vec![0; count],
            bounded: vec![nothing; count],
            waiting: Default::default(),
        }
    }

    /// Finds the queries that have to look into the groups of a region, of which `bounds` are known.
    #[inline(always)]
    fn groups(&mut self, index: &Index, region: usize, bounds: &[f32], asked: &[Asked]) {
        let mut count = 0;
        for (i, (&bound, asked)) in bounds.iter().zip(asked).enumerate() {
            self.queries[count] = i as u32;
            // Not the other way round: a bound that is no number skips nothing.
            count += usize::from(bound > asked.best.limit) ^ 1;
        }
        for (&query, bounded) in self.queries[..count].iter().zip(&mut self.bounded) {
            let asked = &asked[query as usize];
            let bounds = to_groups(index, region, asked);
            *bounded = Bounded {
                query,
                bounds,
                within: Within::of(&bounds, asked.best.limit).of_region(index, region),
            };
        }
        for &Bounded {
            query,
            ref bounds,
            within,
        } in &self.bounded[..count]
        {
            let poses = asked[query as usize].poses;
            for lane in within {
                self.waiting[lane].push(Waiting {
                    query,
                    bound: bounds[lane],
                    codes: poses.to_leaves(region * LANES + lane),
                });
            }
        }
    }

    /// Lets queries look into the leaves of a group.
    #[inline(always)]
    fn leaves(&mut self, index: &Index, region: usize, lane: usize, asked: &mut [Asked]) {
        let group = region * LANES + lane;
        let mut count = 0;
        for &Waiting {
            query,
            bound,
            codes,
        } in &self.waiting[lane]
        {
            let asked = &asked[query as usize];
            if bound > asked.best.limit {
                continue;
            }
            let bounds = to_leaves(index, group, asked, codes);
            let within = Within::of(&bounds, asked.best.limit);
            self.bounded[count] = Bounded {
                query,
                bounds,
                within,
            };
            count += usize::from(within.0 != 0);
        }
        self.waiting[lane].clear();
        for &Bounded {
            query,
            ref bounds,
            within,
        } in &self.bounded[..count]
        {
            compare(index, group, &mut asked[query as usize], bounds, within);
        }
    }
}

/// Offers the rows of those leaves of a group that are `within` the limit.
#[inline(always)]
fn compare(index: &Index, group: usize, asked: &mut Asked, bounds: &[f32; LANES], within: Within) {
    for lane in within {
        // The best may have come nearer since.
        if bounds[lane] > asked.best.limit {
            continue;
        }
        let leaf = group * LANES + lane;
        let distances = distances(&index.tree.leaves[leaf], &asked.query);
        let mut nearer = false;
        for distance in distances {
            nearer |= distance <= asked.best.nearest.distance;
        }
        if !nearer {
            continue;
        }
        for (&id, distance) in index.tree.ids[leaf].iter().zip(distances) {
            asked.best.offer(id, distance, asked.slack);
        }
    }
}

/// The lanes whose bounds let something through, a bit each: found without a branch for every lane.
#[derive(Clone, Copy)]
struct Within(u32);

impl Within {
    #[inline(always)]
    fn of(bounds: &[f32; LANES], limit: f32) -> Self {
        // Not the other way round: a bound that is no number skips nothing.
        let within = bounds.map(|bound| u8::from(bound > limit) ^ 1);
        // Taken from memory: otherwise the compiler asks for each lane alone.
        let bytes = u128::from_le_bytes(std::hint::black_box(within));
        // The factor moves the lowest bit of byte i to bit i of the highest byte.
        let bits = |bytes: u64| (bytes.wrapping_mul(0x0102_0408_1020_4080) >> 56) as u32;
        Within(bits(bytes as u64) | bits((bytes >> 64) as u64) << 8)
    }

    /// Without those for which the last region has no groups.
    #[inline(always)]
    fn of_region(self, index: &Index, region: usize) -> Self {
        let groups = index.tree.inner.len() - region * LANES;
        Within(self.0 & ((1 << groups.min(LANES)) - 1))
    }
}

impl Iterator for Within {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    }
}

/// What has the least bounds, and these, rising.
#[derive(Clone, Copy)]
struct Near([(f32, u32); FIRST]);

impl Near {
    const NONE: Near = Near([(f32::INFINITY, u32::MAX); FIRST]);

    /// Sixteen bounds, of what has the numbers from `first` on.
    #[inline(always)]
    fn offer(&mut self, bounds: &[f32; LANES], first: usize) {
        let mut nearer = false;
        for &bound in bounds {
            nearer |= bound < self.0[FIRST - 1].0;
        }
        if !nearer {
            return;
        }
        for (lane, &bound) in bounds.iter().enumerate() {
            if bound < self.0[FIRST - 1].0 {
                let at = self.0.iter().filter(|near| near.0 <= bound).count();
                self.0[at..].rotate_right(1);
                self.0[at] = (bound, (first + lane) as u32);
            }
        }
    }

    /// Those below `count`: what there is none of is infinitely far away only from what is a number.
    #[inline(always)]
    fn below(self, count: usize) -> impl Iterator<Item = usize> {
        let numbers = self.0.into_iter().map(|near| near.1 as usize);
        numbers.filter(move |&number| number < count)
    }
}

/// Squared distances to sixteen boxes, on top of what is known of the poses.
#[inline(always)]
fn outside(boxes: &Boxes, asked: &[f32; TRAJECTORY_DIM], poses: [f32; LANES]) -> [f32; LANES] {
    let mut sum = poses;
    for ((lows, highs), &asked) in boxes.low.iter().zip(&boxes.high).zip(asked) {
        for ((sum, &low), &high) in sum.iter_mut().zip(lows).zip(highs) {
            let (below, above) = (low - asked, asked - high);
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
fn distances(Lanes(rows): &Lanes, query: &[f32; ROW_STRIDE]) -> [f32; LANES] {
    let (mut a, mut b, mut c, mut d) = ([0.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]);
    for at in (0..FEATURE_DIM).step_by(4) {
        add(&rows[at], query[at], &mut a);
    }
    for at in (1..FEATURE_DIM).step_by(4) {
        add(&rows[at], query[at], &mut b);
    }
    for at in (2..FEATURE_DIM).step_by(4) {
        add(&rows[at], query[at], &mut c);
    }
    for at in (3..FEATURE_DIM).step_by(4) {
        add(&rows[at], query[at], &mut d);
    }
    let mut joined = [0.0; LANES];
    for (lane, joined) in joined.iter_mut().enumerate() {
        *joined = (a[lane] + b[lane]) + (c[lane] + d[lane]);
    }
    joined
}

#[inline(always)]
fn add(rows: &[f32; LANES], asked: f32, sums: &mut [f32; LANES]) {
    for (sum, &row) in sums.iter_mut().zip(rows) {
        let difference = row - asked;
        *sum = difference.mul_add(difference, *sum);
    }
}
