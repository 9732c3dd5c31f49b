//! How near the poses of the database come to each other: a query's pose half is always a row of
//! the database itself, so how far it is from every leaf's poses is known before it is asked.
//!
//! For every block of frames and every leaf, and every group of leaves: the least distance from any
//! pose of the one to any pose of the other, rounded down to a byte. Where memory is too short for a
//! byte for every leaf, boxes around the leaves' poses take their place.

use super::quantised_boxes::{Beyond, Grid, POSE_PAIRS, Place, Rounded};
use super::tree::{self, LANES, Lanes, Tree};
use crate::motion::database::ROW_STRIDE;
use crate::motion::features::POSE_DIM;
use multiversion::multiversion;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

pub struct Poses {
    pub shape: Shape,
    /// The block of every frame.
    pub block_of: Vec<u32>,
    /// `[blocks][groups]`
    pub by_group: Vec<u8>,
    /// `[blocks][groups][LANES]`; empty where memory was short.
    pub by_leaf: Vec<[u8; LANES]>,
    /// Of the boxes; every pose of the database lies on it.
    pub grid: Grid<POSE_DIM, POSE_PAIRS>,
    /// Around the leaves' poses, `[groups]`; only where memory was short.
    boxes: Vec<Rounded<POSE_PAIRS>>,
}

/// Sixteen boxes around poses.
#[repr(align(64))]
struct Boxes {
    low: [[f32; LANES]; POSE_DIM],
    high: [[f32; LANES]; POSE_DIM],
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Frames a block.
    pub block: usize,
    groups: usize,
    /// Distance a step of a code.
    pub step: f32,
}

/// Frames a block, at least and at most.
const BLOCK: [usize; 2] = [4, 128];
/// The largest blocks that are worth a code for every leaf.
const BY_LEAF: usize = 16;
/// Keeps a code's distance below the true one whatever was rounded on the way.
const DOWN: f32 = 1.0 - 1e-5;

impl Poses {
    /// From all `frames` to the rows of `tree`, in at most `memory` bytes; if the coarsest table
    /// needs more, in that.
    pub fn of(frames: &[[f32; ROW_STRIDE]], tree: &Tree, memory: usize) -> Self {
        let groups = tree.inner.len();
        // The block of every frame is part of it, and codes are padded to whole words.
        let memory = memory.saturating_sub(size_of::<u32>() * (frames.len() + 1));
        let find = |codes: usize| {
            let fits = |&block: &usize| frames.len().div_ceil(block) * groups * codes <= memory;
            (BLOCK[0]..BLOCK[1]).find(fits)
        };
        let (block, lanes) = match find(LANES + 1) {
            Some(block) if block <= BY_LEAF => (block, LANES),
            _ => (find(1).unwrap_or(BLOCK[1]), 0),
        };
        let (order, block_of) = sorted(frames, block);
        let sorted: Vec<_> = order.iter().map(|&at| frames[at as usize]).collect();
        let blocks = frames.len().div_ceil(block);
        let step = step(frames);
        let mut poses = Poses {
            shape: Shape {
                block,
                groups,
                step,
            },
            block_of,
            by_group: vec![0; blocks * groups],
            by_leaf: vec![[0; LANES]; blocks * groups * lanes / LANES],
            grid: grid(frames),
            boxes: Vec::new(),
        };
        let boxes = boxes(tree);
        let fine = lanes > 0;
        let mut by_leaf: Vec<&mut [[u8; LANES]]> = poses.by_leaf.chunks_mut(groups).collect();
        by_leaf.resize_with(blocks, || &mut []);
        sorted
            .par_chunks(block)
            .zip(poses.by_group.par_chunks_mut(groups))
            .zip(by_leaf)
            .for_each(|((frames, by_group), by_leaf)| {
                let around = Around::frames(frames);
                for (group, least) in by_group.iter_mut().enumerate() {
                    let leaves = &tree.leaves[group * LANES..][..LANES];
                    let codes = codes(frames, &around, leaves, &boxes[group], step, fine);
                    *least = codes.into_iter().fold(u8::MAX, u8::min);
                    if let Some(kept) = by_leaf.get_mut(group) {
                        *kept = codes;
                    }
                }
            });
        if !fine {
            poses.boxes = widen(&poses.grid, &boxes);
        }
        poses
    }

    /// Of a file, where the codes of the groups are padded to whole words; `None` if these
    /// numbers cannot be of so many frames and groups.
    pub fn restored(
        shape: Shape,
        mut by_group: Vec<u8>,
        by_leaf: Vec<[u8; LANES]>,
        frames: &[[f32; ROW_STRIDE]],
        tree: &Tree,
    ) -> Option<Self> {
        if shape.block == 0 || shape.groups != tree.inner.len() {
            return None;
        }
        let codes = frames.len().div_ceil(shape.block) * shape.groups;
        let fits = by_group.len() == codes.next_multiple_of(4)
            && (by_leaf.is_empty() || by_leaf.len() == codes);
        by_group.truncate(codes);
        let grid = grid(frames);
        let boxes = match by_leaf.is_empty() {
            true => widen(&grid, &boxes(tree)),
            false => Vec::new(),
        };
        fits.then(|| Poses {
            block_of: sorted(frames, shape.block).1,
            shape,
            by_group,
            by_leaf,
            grid,
            boxes,
        })
    }

    pub fn bytes(&self) -> usize {
        self.by_group.len()
            + size_of_val(&self.by_leaf[..])
            + size_of_val(&self.block_of[..])
            + size_of_val(&self.boxes[..])
    }

    /// Raises bounds of a group's leaves that begin with these `codes` by what the boxes around the leaves'
    /// poses say besides, where there are boxes.
    #[inline(always)]
    pub fn raise(
        &self,
        group: usize,
        codes: [u8; LANES],
        place: &Place<POSE_PAIRS>,
        bounds: &mut [f32; LANES],
    ) {
        let Some(boxes) = self.boxes.get(group) else {
            return;
        };
        let outside = self.grid.outside(boxes, place, &Beyond::NOTHING);
        for ((bound, known), outside) in bounds.iter_mut().zip(self.squares(codes)).zip(outside) {
            let more = outside - known;
            *bound += if more > 0.0 { more } else { 0.0 };
        }
    }

    /// Squares of the distances that codes stand for.
    #[inline(always)]
    pub fn squares(&self, codes: [u8; LANES]) -> [f32; LANES] {
        codes.map(|code| {
            let distance = f32::from(code) * self.shape.step;
            distance * distance
        })
    }

    /// What is known of some frames' poses, copied together: so it is fetched in a row, and not here and
    /// there when it is needed.
    pub fn gather(&self, frames: &[u32]) -> Gathered<'_> {
        let groups = self.shape.groups;
        let mut gathered = Gathered {
            poses: self,
            by_region: Vec::with_capacity(frames.len() * groups.div_ceil(LANES)),
            by_group: Vec::with_capacity(frames.len() * groups),
            by_leaf: Vec::new(),
        };
        if !self.by_leaf.is_empty() {
            gathered.by_leaf.reserve(frames.len() * groups);
        }
        for &frame in frames {
            let first = self.block_of[frame as usize] as usize * groups;
            let codes = &self.by_group[first..][..groups];
            gathered.by_group.extend_from_slice(codes);
            gathered.by_region.extend(codes.chunks(LANES).map(least));
            let codes = self.by_leaf.get(first..first + groups);
            gathered
                .by_leaf
                .extend_from_slice(codes.unwrap_or_default());
        }
        gathered
    }
}

/// What is known of some frames' poses.
pub struct Gathered<'a> {
    poses: &'a Poses,
    /// `[frames][regions]`
    by_region: Vec<u8>,
    /// `[frames][groups]`
    by_group: Vec<u8>,
    /// `[frames][groups][LANES]`; empty where there are none.
    by_leaf: Vec<[u8; LANES]>,
}

impl Gathered<'_> {
    /// Of the frame `at` that place.
    #[inline(always)]
    pub fn row(&self, at: usize) -> Row<'_> {
        let groups = self.poses.shape.groups;
        let first = at * groups;
        let regions = groups.div_ceil(LANES);
        Row {
            by_region: &self.by_region[at * regions..][..regions],
            by_group: &self.by_group[first..][..groups],
            by_leaf: self.by_leaf.get(first..first + groups),
        }
    }
}

/// Codes of one frame's least distances to the poses of all leaves.
#[derive(Clone, Copy)]
pub struct Row<'a> {
    by_region: &'a [u8],
    by_group: &'a [u8],
    by_leaf: Option<&'a [[u8; LANES]]>,
}

impl Row<'_> {
    /// To the regions `at` that place among all, sixteen at a time; 0 for those past the end.
    #[inline(always)]
    pub fn to_regions(self, at: usize) -> [u8; LANES] {
        sixteen(&self.by_region[at * LANES..])
    }

    /// To the groups of a region; 0 for those past the end.
    #[inline(always)]
    pub fn to_groups(self, region: usize) -> [u8; LANES] {
        sixteen(&self.by_group[region * LANES..])
    }

    /// To the leaves of a group.
    #[inline(always)]
    pub fn to_leaves(self, group: usize) -> [u8; LANES] {
        match self.by_leaf {
            Some(codes) => codes[group],
            None => [self.by_group[group]; LANES],
        }
    }
}

/// The first sixteen codes; 0 for those past the end.
#[inline(always)]
fn sixteen(codes: &[u8]) -> [u8; LANES] {
    let mut padded = [0; LANES];
    match codes.first_chunk() {
        Some(full) => padded = *full,
        None => padded[..codes.len()].copy_from_slice(codes),
    }
    padded
}

/// Of the codes of a region's groups; sixteen, which almost all have, apart: that needs no loop.
#[inline(always)]
fn least(codes: &[u8]) -> u8 {
    match codes.first_chunk::<LANES>() {
        Some(full) => full.iter().copied().fold(u8::MAX, u8::min),
        None => codes.iter().copied().fold(u8::MAX, u8::min),
    }
}

/// Codes reach two and a half times the deviation of all poses: beyond, they need not tell how far.
fn step(frames: &[[f32; ROW_STRIDE]]) -> f32 {
    let n = frames.len() as f64;
    let variance: f64 = (0..POSE_DIM)
        .map(|i| {
            let values = || frames.iter().map(|row| f64::from(row[i]));
            let mean = values().sum::<f64>() / n;
            values().map(|v| (v - mean).powi(2)).sum::<f64>() / n
        })
        .sum();
    // Of equal poses any step would do but 0.
    (variance.sqrt() as f32 * (2.5 / 255.0)).max(1e-20)
}

/// The order in which blocks take the frames, and the block of each. A few neighbours in time are
/// nearer to each other than what a k-d tree puts together, many are not.
fn sorted(frames: &[[f32; ROW_STRIDE]], block: usize) -> (Vec<u32>, Vec<u32>) {
    let pose = |frame: &[f32; ROW_STRIDE]| -> [f32; POSE_DIM] { std::array::from_fn(|d| frame[d]) };
    let keys: Vec<_> = frames.iter().map(pose).collect();
    let mut order: Vec<u32> = (0..frames.len() as u32).collect();
    if block > BY_LEAF {
        tree::sort(&keys, &mut order, [block]);
    }
    let mut block_of = vec![0; frames.len()];
    for (at, &frame) in order.iter().enumerate() {
        block_of[frame as usize] = (at / block) as u32;
    }
    (order, block_of)
}

impl Boxes {
    fn pack(leaves: &[Around]) -> Self {
        let corner = |of: fn(&Around) -> &[f32; POSE_DIM]| {
            std::array::from_fn(|d| std::array::from_fn(|lane| of(&leaves[lane])[d]))
        };
        Boxes {
            low: corner(|leaf| &leaf.low),
            high: corner(|leaf| &leaf.high),
        }
    }

    /// Squared distances to a box from `least` to `greatest`. Leaves without rows are infinitely far
    /// away.
    #[inline(always)]
    fn outside(&self, least: &[f32], greatest: &[f32]) -> [f32; LANES] {
        let mut sum = [0.0; LANES];
        let boxes = self.low.iter().zip(&self.high);
        for ((lows, highs), (&least, &greatest)) in boxes.zip(least.iter().zip(greatest)) {
            for ((sum, &low), &high) in sum.iter_mut().zip(lows).zip(highs) {
                let (below, above) = (low - greatest, least - high);
                let outside = if below > above { below } else { above };
                let outside = if outside > 0.0 { outside } else { 0.0 };
                *sum = outside.mul_add(outside, *sum);
            }
        }
        sum
    }
}

/// Around the poses of all leaves, by group.
fn boxes(tree: &Tree) -> Vec<Boxes> {
    let around: Vec<Around> = tree.leaves.par_iter().map(Around::leaf).collect();
    around.chunks(LANES).map(Boxes::pack).collect()
}

/// Of all poses.
fn grid(frames: &[[f32; ROW_STRIDE]]) -> Grid<POSE_DIM, POSE_PAIRS> {
    let Around { low, high } = Around::frames(frames);
    Grid::around(&low, &high)
}

fn widen(grid: &Grid<POSE_DIM, POSE_PAIRS>, boxes: &[Boxes]) -> Vec<Rounded<POSE_PAIRS>> {
    let widen = |boxes: &Boxes| grid.widen(&boxes.low, &boxes.high);
    boxes.iter().map(widen).collect()
}

/// The box around some poses.
struct Around {
    low: [f32; POSE_DIM],
    high: [f32; POSE_DIM],
}

impl Around {
    fn nothing() -> Self {
        Around {
            low: [f32::INFINITY; POSE_DIM],
            high: [f32::NEG_INFINITY; POSE_DIM],
        }
    }

    fn add(&mut self, dimension: usize, value: f32) {
        // Lanes without a row hold infinity.
        if value < f32::INFINITY {
            self.low[dimension] = self.low[dimension].min(value);
            self.high[dimension] = self.high[dimension].max(value);
        }
    }

    fn leaf(Lanes(leaf): &Lanes) -> Self {
        let mut around = Self::nothing();
        for (dimension, lanes) in leaf.iter().enumerate().take(POSE_DIM) {
            lanes.iter().for_each(|&value| around.add(dimension, value));
        }
        around
    }

    fn frames(frames: &[[f32; ROW_STRIDE]]) -> Self {
        let mut around = Self::nothing();
        for frame in frames {
            let pose = frame.iter().enumerate().take(POSE_DIM);
            pose.for_each(|(dimension, &value)| around.add(dimension, value));
        }
        around
    }
}

/// Of every leaf of a group; if not `fine`, only the least of them has a meaning. Leaves whose box is
/// too far from that `around` the frames are not looked into: an error of rounding there is far less
/// than [`DOWN`] allows.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
fn codes(
    frames: &[[f32; ROW_STRIDE]],
    around: &Around,
    leaves: &[Lanes],
    boxes: &Boxes,
    step: f32,
    fine: bool,
) -> [u8; LANES] {
    let apart = boxes.outside(&around.low, &around.high);
    let mut nearest = [f32::INFINITY; LANES];
    let mut first = 0;
    for (lane, &other) in apart.iter().enumerate() {
        if other < apart[first] {
            first = lane;
        }
    }
    // Beyond, all codes are the same.
    let end = 255.0 / DOWN * step * (1.0 + 1e-6);
    let mut limit = end * end;
    for turn in 0..LANES {
        // The one that lies nearest first, then the others in order.
        let lane = match turn {
            0 => first,
            _ => turn - usize::from(turn <= first),
        };
        if apart[lane] >= limit {
            continue;
        }
        let mut least = [f32::INFINITY; LANES];
        for frame in frames {
            let mut sum = [0.0f32; LANES];
            for (&value, lanes) in frame.iter().zip(&leaves[lane].0[..POSE_DIM]) {
                for (sum, &row) in sum.iter_mut().zip(lanes) {
                    let difference = row - value;
                    *sum = difference.mul_add(difference, *sum);
                }
            }
            for (least, sum) in least.iter_mut().zip(sum) {
                *least = if sum < *least { sum } else { *least };
            }
        }
        for least in least {
            nearest[lane] = if least < nearest[lane] {
                least
            } else {
                nearest[lane]
            };
        }
        if !fine && nearest[lane] < limit {
            limit = nearest[lane];
        }
    }
    let mut codes = [0; LANES];
    for (code, nearest) in codes.iter_mut().zip(nearest) {
        // The cast stops at 255.
        *code = (nearest.sqrt() * DOWN / step) as u8;
    }
    codes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::rng::{gaussian, random4};
    use super::pca::Axes;

    /// Skipping leaves that lie far apart changes no code.
    #[test]
    fn codes_are_those_of_comparing_all() {
        let frames: Vec<[f32; ROW_STRIDE]> = (0..3000)
            .map(|i| {
                // Ten bundles, so that many leaves lie far apart.
                let bundle = i % 10;
                std::array::from_fn(|d| {
                    let centre = 3.0 * gaussian(random4(1, bundle, d as u32, 0));
                    centre + gaussian(random4(2, i, d as u32, 0))
                })
            })
            .collect();
        let tree = Tree::of(&frames, &Axes::of(&frames), None);
        let (groups, step) = (tree.inner.len(), step(&frames));
        let whole = Around::frames(&frames);
        let everywhere = Boxes {
            low: [[-1e9; LANES]; POSE_DIM],
            high: [[1e9; LANES]; POSE_DIM],
        };
        for memory in [1 << 30, 0] {
            let poses = Poses::of(&frames, &tree, memory);
            assert_eq!(poses.by_leaf.is_empty(), memory == 0);
            for (block, by_group) in poses.by_group.chunks(groups).enumerate() {
                let of_block = |&at: &usize| poses.block_of[at] as usize == block;
                let inside: Vec<_> = (0..frames.len()).filter(of_block).collect();
                let inside: Vec<_> = inside.into_iter().map(|at| frames[at]).collect();
                for (group, &code) in by_group.iter().enumerate() {
                    let leaves = &tree.leaves[group * LANES..][..LANES];
                    let plain = codes(&inside, &whole, leaves, &everywhere, step, true);
                    assert_eq!(Some(&code), plain.iter().min());
                    if let Some(by_leaf) = poses.by_leaf.get(block * groups + group) {
                        assert_eq!(*by_leaf, plain);
                    }
                }
            }
        }
    }
}
