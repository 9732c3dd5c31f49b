//! Exact nearest-row search on the CPU: SIMD over sixteen rows at a time, all cores over the
//! queries, and two levels of bounding boxes to leave most rows unread.
//!
//! Rows are sorted into a balanced k-d tree's leaves of 16 rows; 16 neighbouring leaves share an
//! outer box. A box's distance to the query bounds its rows' distances from below, in floating
//! point too: rounding is monotonic, and boxes and rows are summed in the same order. So
//! pruning needs no tolerance and the answer is, bit for bit, the plain one of
//! [`crate::kernels::search_exact::twin`], the lowest index of equals included.

use crate::motion::database::PADDED;
use crate::motion::features::FEATURE;
use multiversion::multiversion;
use rayon::prelude::*;

/// Rows a leaf, leaves a group: the width of the widest vector registers.
const LANES: usize = 16;
const GROUP: usize = LANES * LANES;
/// Queries a task of the thread pool answers.
const TASK: usize = 16;

/// Sixteen feature rows, or sixteen corners of boxes, dimension by dimension.
type Lanes = [[f32; LANES]; FEATURE];

/// Sixteen boxes.
struct Boxes {
    low: Lanes,
    high: Lanes,
}

/// The rows, sorted for pruning.
pub struct Index {
    leaves: Vec<Lanes>,
    /// Original index of every row of every leaf.
    ids: Vec<[u32; LANES]>,
    /// Boxes of the leaves, sixteen a group.
    inner: Vec<Boxes>,
    /// Boxes of the groups, sixteen at a time.
    outer: Vec<Boxes>,
}

/// The nearest row and its squared distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    pub index: u32,
    pub distance: f32,
}

impl Index {
    /// Sorts `rows`, of which there must be at least one.
    pub fn build(rows: &[[f32; PADDED]]) -> Self {
        let mut order: Vec<u32> = (0..rows.len() as u32).collect();
        sort(rows, &mut order);
        let groups = rows.len().div_ceil(GROUP);
        // Lanes without a row hold infinity: never nearest.
        let mut leaves = vec![[[f32::INFINITY; LANES]; FEATURE]; groups * LANES];
        let mut ids = vec![[u32::MAX; LANES]; groups * LANES];
        for (at, &id) in order.iter().enumerate() {
            let (leaf, lane) = (at / LANES, at % LANES);
            ids[leaf][lane] = id;
            for (dimension, lanes) in leaves[leaf].iter_mut().enumerate() {
                lanes[lane] = rows[id as usize][dimension];
            }
        }
        let corners: Vec<_> = leaves
            .iter()
            .zip(&ids)
            .map(|(leaf, ids)| corners_of_leaf(leaf, ids))
            .collect();
        let inner: Vec<Boxes> = corners.chunks(LANES).map(pack).collect();
        let corners: Vec<_> = corners.chunks(LANES).map(corners_of_group).collect();
        let outer = corners.chunks(LANES).map(pack).collect();
        Index {
            leaves,
            ids,
            inner,
            outer,
        }
    }

    /// Bytes of memory held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.leaves[..])
            + size_of_val(&self.ids[..])
            + size_of_val(&self.inner[..])
            + size_of_val(&self.outer[..])
    }

    /// Nearest row of one query; of equals the lowest index.
    pub fn nearest(&self, query: &[f32; PADDED]) -> Nearest {
        nearest(self, query)
    }

    /// Nearest row of every query, on all cores.
    pub fn nearest_all(&self, queries: &[[f32; PADDED]], found: &mut [u32]) {
        queries
            .par_chunks(TASK)
            .zip(found.par_chunks_mut(TASK))
            .for_each(|(queries, found)| {
                for (query, found) in queries.iter().zip(found) {
                    *found = self.nearest(query).index;
                }
            });
    }
}

/// Splits at the median of the widest dimension until a leaf is left. Halves hold whole groups,
/// later whole leaves, so that leaves fill up and groups are subtrees.
fn sort(rows: &[[f32; PADDED]], order: &mut [u32]) {
    if order.len() <= LANES {
        // Ascending ids: the first of equals in a leaf has the lowest.
        order.sort_unstable();
        return;
    }
    let unit = if order.len() > GROUP { GROUP } else { LANES };
    let middle = (order.len().div_ceil(unit) / 2) * unit;
    let dimension = widest(rows, order);
    order.select_nth_unstable_by(middle, |&a, &b| {
        rows[a as usize][dimension]
            .total_cmp(&rows[b as usize][dimension])
            .then(a.cmp(&b))
    });
    let (left, right) = order.split_at_mut(middle);
    rayon::join(|| sort(rows, left), || sort(rows, right));
}

/// The dimension of the largest variance.
fn widest(rows: &[[f32; PADDED]], order: &[u32]) -> usize {
    let (mut sum, mut square) = ([0.0f64; FEATURE], [0.0f64; FEATURE]);
    for &id in order {
        for dimension in 0..FEATURE {
            let value = f64::from(rows[id as usize][dimension]);
            sum[dimension] += value;
            square[dimension] += value * value;
        }
    }
    let n = order.len() as f64;
    let variance = |d: usize| square[d] - sum[d] * sum[d] / n;
    (0..FEATURE)
        .max_by(|&a, &b| variance(a).total_cmp(&variance(b)))
        .unwrap_or(0)
}

type Corners = ([f32; FEATURE], [f32; FEATURE]);

fn corners_of_leaf(leaf: &Lanes, ids: &[u32; LANES]) -> Corners {
    let over = |start: f32, join: fn(f32, f32) -> f32| {
        leaf.map(|lanes| {
            let filled = lanes.iter().zip(ids).filter(|&(_, &id)| id != u32::MAX);
            filled.map(|(&value, _)| value).fold(start, join)
        })
    };
    let empty = ids[0] == u32::MAX;
    let high = if empty {
        f32::INFINITY
    } else {
        f32::NEG_INFINITY
    };
    (over(f32::INFINITY, f32::min), over(high, f32::max))
}

fn corners_of_group(leaves: &[Corners]) -> Corners {
    let filled = || leaves.iter().filter(|(low, _)| low[0] < f32::INFINITY);
    (
        std::array::from_fn(|d| {
            filled()
                .map(|(low, _)| low[d])
                .fold(f32::INFINITY, f32::min)
        }),
        std::array::from_fn(|d| {
            filled()
                .map(|(_, high)| high[d])
                .fold(f32::NEG_INFINITY, f32::max)
        }),
    )
}

/// Lanes without a box are infinitely far away.
fn pack(corners: &[Corners]) -> Boxes {
    let lanes = |of: &dyn Fn(&Corners) -> [f32; FEATURE]| {
        let columns: Vec<_> = corners.iter().map(of).collect();
        std::array::from_fn(|d| {
            std::array::from_fn(|lane| columns.get(lane).map_or(f32::INFINITY, |c| c[d]))
        })
    };
    Boxes {
        low: lanes(&|c| c.0),
        high: lanes(&|c| c.1),
    }
}

#[inline(always)]
fn distances(rows: &Lanes, query: &[f32; PADDED]) -> [f32; LANES] {
    interleaved(|d, sum| {
        for (sum, &row) in sum.iter_mut().zip(&rows[d]) {
            let difference = row - query[d];
            *sum = difference.mul_add(difference, *sum);
        }
    })
}

#[inline(always)]
fn bounds(boxes: &Boxes, query: &[f32; PADDED]) -> [f32; LANES] {
    interleaved(|d, sum| {
        for ((sum, &low), &high) in sum.iter_mut().zip(&boxes.low[d]).zip(&boxes.high[d]) {
            let (below, above) = (low - query[d], query[d] - high);
            let outside = if below > above { below } else { above };
            let outside = if outside > 0.0 { outside } else { 0.0 };
            *sum = outside.mul_add(outside, *sum);
        }
    })
}

/// Adds up all dimensions in the four interleaved sums of
/// [`squared`](crate::kernels::search_exact::squared).
#[inline(always)]
fn interleaved(add: impl Fn(usize, &mut [f32; LANES])) -> [f32; LANES] {
    let (mut a, mut b, mut c, mut d) = ([0.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]);
    for quad in (0..FEATURE).step_by(4) {
        add(quad, &mut a);
        add(quad + 1, &mut b);
        add(quad + 2, &mut c);
        if quad + 3 < FEATURE {
            add(quad + 3, &mut d);
        }
    }
    let mut joined = [0.0; LANES];
    for (lane, joined) in joined.iter_mut().enumerate() {
        *joined = (a[lane] + b[lane]) + (c[lane] + d[lane]);
    }
    joined
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
fn nearest(index: &Index, query: &[f32; PADDED]) -> Nearest {
    // Row 0 stands when nothing is nearer than infinity, as with a query that is not a number.
    let mut best = Nearest {
        index: 0,
        distance: f32::INFINITY,
    };
    // First the group whose box is nearest: its winner lets most others be skipped.
    let mut near = (f32::INFINITY, 0);
    let mut outer = Vec::with_capacity(index.outer.len() * LANES);
    for boxes in &index.outer {
        outer.extend(bounds(boxes, query));
    }
    for (group, &bound) in outer.iter().enumerate() {
        if bound < near.0 {
            near = (bound, group);
        }
    }
    visit(index, near.1, query, &mut best);
    for (group, &bound) in outer.iter().enumerate() {
        if bound <= best.distance && group != near.1 {
            visit(index, group, query, &mut best);
        }
    }
    best
}

/// Looks into the leaves of a group that may hold something nearer, or as near and lower.
#[inline(always)]
fn visit(index: &Index, group: usize, query: &[f32; PADDED], best: &mut Nearest) {
    let Some(boxes) = index.inner.get(group) else {
        return;
    };
    let inner = bounds(boxes, query);
    for (lane, bound) in inner.into_iter().enumerate() {
        if bound > best.distance {
            continue;
        }
        let leaf = group * LANES + lane;
        let distances = distances(&index.leaves[leaf], query);
        let mut least = distances[0];
        for d in distances {
            least = if d < least { d } else { least };
        }
        if least > best.distance {
            continue;
        }
        for (&id, d) in index.ids[leaf].iter().zip(distances) {
            if d < best.distance || (d == best.distance && id < best.index) {
                *best = Nearest {
                    index: id,
                    distance: d,
                };
            }
        }
    }
}
