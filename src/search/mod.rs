//! Exact nearest-row search on the CPU: all cores over the queries, sixteen rows at a time, and
//! most rows left unread because a lower bound says that they cannot be nearest.
//!
//! The bound of a leaf is the least distance of its poses to the query's, which is known
//! beforehand ([`poses`]), and the distance of the query's trajectory to the box around the leaf's
//! along the principal axes ([`axes`], [`tree`]). Bounds are widened by more than rounding can do,
//! and distances are those of [`crate::kernels::search_exact::squared`]: the answer is, bit for
//! bit, that of [`crate::kernels::search_exact::twin`], the lowest index of equals included.

mod axes;
mod packed;
mod poses;
mod tree;

use crate::motion::database::PADDED;
use crate::motion::features::{FEATURE, POSE, TRAJECTORY};
use crate::store::{Arrays, Format, StoreError};
use axes::Axes;
use multiversion::multiversion;
pub use packed::Packed;
use poses::{Poses, Row, Shape};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::Path;
use tree::{Boxes, LANES, Lanes, Tree};

/// Queries that a task of the thread pool answers together, at least and at most: what one of them has
/// fetched from memory serves the others. In between, so many that each has to fetch [`SHARE`] bytes.
const TASK: [usize; 2] = [16, 2048];
const SHARE: usize = 1 << 16;
/// Groups of a query that are looked into before all others: their winner lets most of those be skipped.
const FIRST: usize = 4;
/// Bytes of the table of poses unless asked otherwise: WebGPU's default limit of a binding.
pub const MEMORY: usize = 128 << 20;

/// The rows, sorted for pruning, and what is known of their poses.
pub struct Index {
    axes: Axes,
    tree: Tree,
    poses: Poses,
    /// Length of the longest trajectory.
    longest: f32,
}

const FORMAT: Format = Format {
    kind: "index",
    version: 3,
};

#[derive(Serialize, Deserialize)]
struct Header {
    /// Of the database.
    fingerprint: u32,
    shape: Shape,
}

/// Files hold whole words.
fn padded(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes
}

/// The nearest row and its squared distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    pub index: u32,
    pub distance: f32,
}

impl Nearest {
    /// Row 0 stands when nothing is nearer than infinity, as with a query that is not a number.
    const NONE: Nearest = Nearest {
        index: 0,
        distance: f32::INFINITY,
    };
}

impl Index {
    /// Of the rows `candidates` of `frames`, of which there must be at least one. The table of poses
    /// takes at most `memory` bytes, or as little as it can.
    pub fn build(frames: &[[f32; PADDED]], candidates: &[u32], memory: usize) -> Self {
        let rows: Vec<_> = candidates.iter().map(|&at| frames[at as usize]).collect();
        let axes = Axes::of(&rows);
        let tree = Tree::of(&rows, &axes, None);
        let poses = Poses::of(frames, &tree, memory);
        Self::join(&rows, axes, tree, poses)
    }

    fn join(rows: &[[f32; PADDED]], axes: Axes, tree: Tree, poses: Poses) -> Self {
        Index {
            longest: rows.iter().map(length).fold(0.0, f32::max),
            axes,
            tree,
            poses,
        }
    }

    /// Writes what is slow to find: the order of the rows and the table of poses.
    pub fn save(&self, path: &Path, fingerprint: u32) -> Result<(), StoreError> {
        let mut arrays = Arrays::default();
        arrays.put("order", &self.tree.order());
        arrays.put("by_leaf", &self.poses.by_leaf);
        arrays.put("by_group", &padded(&self.poses.by_group));
        let header = Header {
            fingerprint,
            shape: self.poses.shape,
        };
        crate::store::save(path, FORMAT, &header, &arrays)
    }

    /// Reads a file written by [`Index::save`]; `None` if there is none, or none of this database
    /// (`fingerprint`) in this form: then it must be built.
    pub fn load(
        path: &Path,
        fingerprint: u32,
        frames: &[[f32; PADDED]],
        candidates: &[u32],
    ) -> Option<Self> {
        let (header, mut arrays) = crate::store::load::<Header>(path, FORMAT).ok()?;
        let order: Vec<u32> = arrays.take("order")?;
        let mut sorted = order.clone();
        sorted.sort_unstable();
        let whole = sorted.iter().copied().eq(0..candidates.len() as u32);
        if header.fingerprint != fingerprint || !whole {
            return None;
        }
        let rows: Vec<_> = candidates.iter().map(|&at| frames[at as usize]).collect();
        let axes = Axes::of(&rows);
        let tree = Tree::of(&rows, &axes, Some(order));
        let poses = Poses::restored(
            header.shape,
            arrays.take("by_group")?,
            arrays.take("by_leaf")?,
            frames,
            &tree,
        )?;
        Some(Self::join(&rows, axes, tree, poses))
    }

    /// Bytes of memory held.
    pub fn bytes(&self) -> usize {
        self.tree.bytes() + self.poses.bytes()
    }

    /// Nearest candidate of one query, whose pose half is that of `frame`; of equals the lowest.
    pub fn nearest(&self, frame: u32, query: &[f32; PADDED]) -> Nearest {
        let mut found = [Nearest::NONE];
        nearest(self, &[frame], &[*query], &mut found);
        found[0]
    }

    /// Nearest candidate of every query, on all cores.
    pub fn nearest_all(&self, frames: &[u32], queries: &[[f32; PADDED]], found: &mut [u32]) {
        // As many tasks for every thread, lest one wait for another's last.
        let threads = rayon::current_num_threads();
        let enough = (self.tree.bytes() / SHARE).clamp(TASK[0], TASK[1]);
        let rounds = queries.len().div_ceil(threads * enough).max(1);
        let task = queries.len().div_ceil(threads * rounds).max(TASK[0]);
        frames
            .par_chunks(task)
            .zip(queries.par_chunks(task))
            .zip(found.par_chunks_mut(task))
            .for_each(|((frames, queries), found)| {
                let mut nearest = vec![Nearest::NONE; found.len()];
                self::nearest(self, frames, queries, &mut nearest);
                for (found, nearest) in found.iter_mut().zip(nearest) {
                    *found = nearest.index;
                }
            });
    }
}

/// Of a row's trajectory.
fn length(row: &[f32; PADDED]) -> f32 {
    let squares = row[POSE..FEATURE].iter().map(|value| value * value);
    squares.sum::<f32>().sqrt()
}

/// What is asked, in the forms the bounds need.
struct Asked<'a> {
    query: &'a [f32; PADDED],
    poses: Row<'a>,
    trajectory: [f32; TRAJECTORY],
    /// Rounding may lengthen a bound (no square) by this and by [`RELATIVE`]: a rotated number
    /// and its difference to another have errors of a few 2^-24 of the two vectors' lengths.
    slack: f32,
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
fn nearest(index: &Index, frames: &[u32], queries: &[[f32; PADDED]], found: &mut [Nearest]) {
    let poses = index.poses.gather(frames);
    let asked = |(at, query)| Asked {
        query,
        poses: poses.row(at),
        trajectory: index.axes.turn(query),
        slack: SLACK * (index.longest + length(query)),
    };
    let asked: Vec<Asked> = queries.iter().enumerate().map(asked).collect();
    // Of sixteen groups at a time, for every query.
    let mut outer = Vec::with_capacity(index.tree.outer.len() * asked.len());
    let mut near = vec![[(f32::INFINITY, usize::MAX); FIRST]; asked.len()];
    for (at, boxes) in index.tree.outer.iter().enumerate() {
        for (asked, near) in asked.iter().zip(&mut near) {
            let poses = asked.poses.to_groups(at * LANES);
            let bounds = bounds(boxes, &asked.trajectory, poses);
            let least = bounds.iter().fold(f32::INFINITY, |least, &b| least.min(b));
            if least < near[FIRST - 1].0 {
                for (lane, &bound) in bounds.iter().enumerate() {
                    if bound < near[FIRST - 1].0 {
                        insert(near, (bound, at * LANES + lane));
                    }
                }
            }
            outer.push(bounds);
        }
    }
    let seeded = asked.iter().zip(&near).map(|(asked, near)| {
        let mut best = Best {
            nearest: Nearest::NONE,
            limit: f32::INFINITY,
        };
        for &(_, group) in near {
            visit(&index.tree, group, asked, &mut best);
        }
        best
    });
    let mut best: Vec<Best> = seeded.collect();
    // Then sixteen groups after sixteen, for all queries, while they are at hand.
    for (at, outer) in outer.chunks_exact(asked.len()).enumerate() {
        for (i, bounds) in outer.iter().enumerate() {
            for lane in Within::of(bounds, best[i].limit) {
                let group = at * LANES + lane;
                if bounds[lane] > best[i].limit || near[i].iter().any(|near| near.1 == group) {
                    continue;
                }
                visit(&index.tree, group, &asked[i], &mut best[i]);
            }
        }
    }
    for (found, best) in found.iter_mut().zip(best) {
        *found = best.nearest;
    }
}

/// The lanes whose bounds let something through, a byte each: found without a branch for every lane.
struct Within(u128);

impl Within {
    #[inline(always)]
    fn of(bounds: &[f32; LANES], limit: f32) -> Self {
        // Not the other way round: a bound that is no number skips nothing.
        let within = bounds.map(|bound| u8::from(bound > limit) ^ 1);
        Within(u128::from_le_bytes(within))
    }
}

impl Iterator for Within {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let lane = self.0.trailing_zeros() as usize / 8;
        self.0 &= self.0.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    }
}

/// Puts a group where it belongs among the nearest, the last of which it displaces.
#[inline(always)]
fn insert(near: &mut [(f32, usize); FIRST], group: (f32, usize)) {
    let at = near.iter().filter(|near| near.0 <= group.0).count();
    near[at..].rotate_right(1);
    near[at] = group;
}

/// Looks into the leaves of a group that may hold something nearer, or as near and lower.
#[inline(always)]
fn visit(tree: &Tree, group: usize, asked: &Asked, best: &mut Best) {
    let Some(boxes) = tree.inner.get(group) else {
        return;
    };
    let mut inner = bounds(boxes, &asked.trajectory, asked.poses.to_leaves(group));
    if Within::of(&inner, best.limit).0 == 0 {
        return;
    }
    asked.poses.raise(group, asked.query, &mut inner);
    for lane in Within::of(&inner, best.limit) {
        // The best may have come nearer since.
        if inner[lane] > best.limit {
            continue;
        }
        let leaf = group * LANES + lane;
        let distances = distances(&tree.leaves[leaf], asked.query);
        let mut nearer = false;
        for distance in distances {
            nearer |= distance <= best.nearest.distance;
        }
        if !nearer {
            continue;
        }
        for (&id, distance) in tree.ids[leaf].iter().zip(distances) {
            best.offer(id, distance, asked.slack);
        }
    }
}

/// Squared distances to sixteen boxes, on top of what is known of the poses.
#[inline(always)]
fn bounds(boxes: &Boxes, asked: &[f32; TRAJECTORY], poses: [f32; LANES]) -> [f32; LANES] {
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
/// [`squared`](crate::kernels::search_exact::squared).
#[inline(always)]
fn distances(Lanes(rows): &Lanes, query: &[f32; PADDED]) -> [f32; LANES] {
    let mut sums = [[0.0; LANES]; 4];
    for quad in 0..FEATURE / 4 {
        for (i, sum) in sums.iter_mut().enumerate() {
            add(&rows[4 * quad + i], query[4 * quad + i], sum);
        }
    }
    for (i, sum) in sums.iter_mut().enumerate().take(FEATURE % 4) {
        add(&rows[FEATURE / 4 * 4 + i], query[FEATURE / 4 * 4 + i], sum);
    }
    let [a, b, c, d] = sums;
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

impl std::fmt::Debug for Index {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "index of {} bytes", self.bytes())
    }
}
