//! Distances between the poses of the database: a query's pose half is always a row of the database
//! itself, so its distance to every leaf's poses is known beforehand.
//!
//! For every block of frames and every leaf, and every group of leaves: the least distance from any
//! pose of the one to any pose of the other, rounded down to a byte. Where memory is too short for a
//! byte for every leaf, boxes around the leaves' poses take their place.

use super::quantised_boxes::{
    GridPoint, LANES, OutOfGrid, POSE_PAIRS, QuantisationGrid, QuantisedBoxes,
};
use super::tree::{self, KdTree, LeafRows};
use crate::motion::features::{POSE_DIM, ROW_STRIDE};
use multiversion::multiversion;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Least distances from blocks of frames to groups and leaves, a byte each.
pub struct PoseDistanceTable {
    pub layout: TableLayout,
    /// The block of every frame.
    pub block_of: Vec<u32>,
    /// `[blocks][groups]`
    pub by_group: Vec<u8>,
    /// `[blocks][groups][LANES]`; empty where memory was short.
    pub by_leaf: Vec<[u8; LANES]>,
    /// Grid of the boxes, which encloses every pose of the database.
    pub grid: QuantisationGrid<POSE_DIM, POSE_PAIRS>,
    /// Boxes around the leaves' poses, `[groups]`; only where memory was short.
    boxes: Vec<QuantisedBoxes<POSE_PAIRS>>,
}

/// Sixteen boxes around poses.
#[repr(align(64))]
struct PoseBoxes {
    low: [[f32; LANES]; POSE_DIM],
    high: [[f32; LANES]; POSE_DIM],
}

/// Sizes of a table, and the unit of its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TableLayout {
    /// Frames a block.
    pub block: usize,
    groups: usize,
    /// Distance a unit of a code.
    pub step: f32,
}

/// Frames a block, at least and at most.
const BLOCK_FRAMES: [usize; 2] = [4, 128];
/// Frames of the largest blocks that are worth a code for every leaf.
const MAX_BLOCK_BY_LEAF: usize = 16;
/// Keeps a code's distance below the true one whatever was rounded on the way.
const ROUND_DOWN: f32 = 1.0 - 1e-5;

impl PoseDistanceTable {
    /// Distances from all `frames` to the rows of `tree`, in at most `memory` bytes; if the coarsest
    /// table needs more, in that.
    pub fn build(frames: &[[f32; ROW_STRIDE]], tree: &KdTree, memory: usize) -> Self {
        let groups = tree.leaf_boxes.len();
        // The block of every frame is part of it, and codes are padded to whole words.
        let memory = memory.saturating_sub(size_of::<u32>() * (frames.len() + 1));
        let smallest_block = |codes: usize| {
            let fits = |&block: &usize| frames.len().div_ceil(block) * groups * codes <= memory;
            (BLOCK_FRAMES[0]..BLOCK_FRAMES[1]).find(fits)
        };
        let (block, lanes) = match smallest_block(LANES + 1) {
            Some(block) if block <= MAX_BLOCK_BY_LEAF => (block, LANES),
            _ => (smallest_block(1).unwrap_or(BLOCK_FRAMES[1]), 0),
        };
        let (order, block_of) = assign_blocks(frames, block);
        let sorted: Vec<_> = order.iter().map(|&at| frames[at as usize]).collect();
        let blocks = frames.len().div_ceil(block);
        let step = code_step(frames);
        let mut table = PoseDistanceTable {
            layout: TableLayout {
                block,
                groups,
                step,
            },
            block_of,
            by_group: vec![0; blocks * groups],
            by_leaf: vec![[0; LANES]; blocks * groups * lanes / LANES],
            grid: pose_grid(frames),
            boxes: Vec::new(),
        };
        let boxes = leaf_boxes(tree);
        let each_leaf = lanes > 0;
        let mut by_leaf: Vec<&mut [[u8; LANES]]> = table.by_leaf.chunks_mut(groups).collect();
        by_leaf.resize_with(blocks, || &mut []);
        sorted
            .par_chunks(block)
            .zip(table.by_group.par_chunks_mut(groups))
            .zip(by_leaf)
            .for_each(|((frames, by_group), by_leaf)| {
                let bounds = PoseBounds::of_frames(frames);
                for (group, least) in by_group.iter_mut().enumerate() {
                    let leaves = &tree.leaves[group * LANES..][..LANES];
                    let codes =
                        distance_codes(frames, &bounds, leaves, &boxes[group], step, each_leaf);
                    *least = codes.into_iter().fold(u8::MAX, u8::min);
                    if let Some(kept) = by_leaf.get_mut(group) {
                        *kept = codes;
                    }
                }
            });
        if !each_leaf {
            table.boxes = quantise(&table.grid, &boxes);
        }
        table
    }

    /// The table out of a file, where the codes of the groups are padded to whole words; `None` if these
    /// numbers cannot be of so many frames and groups.
    pub fn restore(
        layout: TableLayout,
        mut by_group: Vec<u8>,
        by_leaf: Vec<[u8; LANES]>,
        frames: &[[f32; ROW_STRIDE]],
        tree: &KdTree,
    ) -> Option<Self> {
        if layout.block == 0 || layout.groups != tree.leaf_boxes.len() {
            return None;
        }
        let codes = frames.len().div_ceil(layout.block) * layout.groups;
        let fits = by_group.len() == codes.next_multiple_of(4)
            && (by_leaf.is_empty() || by_leaf.len() == codes);
        by_group.truncate(codes);
        let grid = pose_grid(frames);
        let boxes = match by_leaf.is_empty() {
            true => quantise(&grid, &leaf_boxes(tree)),
            false => Vec::new(),
        };
        fits.then(|| PoseDistanceTable {
            block_of: assign_blocks(frames, layout.block).1,
            layout,
            by_group,
            by_leaf,
            grid,
            boxes,
        })
    }

    /// Bytes of memory held.
    pub fn bytes(&self) -> usize {
        self.by_group.len()
            + size_of_val(&self.by_leaf[..])
            + size_of_val(&self.block_of[..])
            + size_of_val(&self.boxes[..])
    }

    /// Raises lower bounds of a group's leaves that include these `codes` to what the boxes around the
    /// leaves' poses say, where there are boxes.
    #[inline(always)]
    pub fn raise_bounds(
        &self,
        group: usize,
        codes: [u8; LANES],
        pose: &GridPoint<POSE_PAIRS>,
        bounds: &mut [f32; LANES],
    ) {
        let Some(boxes) = self.boxes.get(group) else {
            return;
        };
        let to_boxes = self.grid.squared_distances(boxes, pose, &OutOfGrid::NONE);
        let known = self.squared_distances(codes);
        for ((bound, known), to_box) in bounds.iter_mut().zip(known).zip(to_boxes) {
            let more = to_box - known;
            *bound += if more > 0.0 { more } else { 0.0 };
        }
    }

    /// Squared distances that codes stand for.
    #[inline(always)]
    pub fn squared_distances(&self, codes: [u8; LANES]) -> [f32; LANES] {
        codes.map(|code| {
            let distance = f32::from(code) * self.layout.step;
            distance * distance
        })
    }

    /// The codes of some frames, copied together: so they are fetched in sequence, and not here and there
    /// when they are needed.
    pub fn gather(&self, frames: &[u32]) -> GatheredCodes {
        let groups = self.layout.groups;
        let mut gathered = GatheredCodes {
            groups,
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
            gathered.by_region.extend(codes.chunks(LANES).map(min_code));
            let codes = self.by_leaf.get(first..first + groups);
            gathered
                .by_leaf
                .extend_from_slice(codes.unwrap_or_default());
        }
        gathered
    }

    /// The codes of one frame, where they are stored; those of the regions are put into `by_region`.
    #[inline(always)]
    pub fn codes<'a>(&'a self, frame: u32, by_region: &'a mut Vec<u8>) -> PoseCodes<'a> {
        let groups = self.layout.groups;
        let first = self.block_of[frame as usize] as usize * groups;
        let by_group = &self.by_group[first..][..groups];
        by_region.clear();
        by_region.extend(by_group.chunks(LANES).map(min_code));
        PoseCodes {
            by_region,
            by_group,
            by_leaf: self.by_leaf.get(first..first + groups),
        }
    }
}

/// Codes of some frames' least distances to the poses of all leaves.
pub struct GatheredCodes {
    groups: usize,
    /// `[frames][regions]`
    by_region: Vec<u8>,
    /// `[frames][groups]`
    by_group: Vec<u8>,
    /// `[frames][groups][LANES]`; empty where there are none.
    by_leaf: Vec<[u8; LANES]>,
}

impl GatheredCodes {
    /// Codes of the frame at that index of those gathered.
    #[inline(always)]
    pub fn row(&self, at: usize) -> PoseCodes<'_> {
        let groups = self.groups;
        let first = at * groups;
        let regions = groups.div_ceil(LANES);
        PoseCodes {
            by_region: &self.by_region[at * regions..][..regions],
            by_group: &self.by_group[first..][..groups],
            by_leaf: self.by_leaf.get(first..first + groups),
        }
    }
}

/// Codes of one frame's least distances to the poses of all leaves.
#[derive(Clone, Copy)]
pub struct PoseCodes<'a> {
    by_region: &'a [u8],
    by_group: &'a [u8],
    by_leaf: Option<&'a [[u8; LANES]]>,
}

impl PoseCodes<'_> {
    /// Codes of the sixteen regions at that index of all sixteens; 0 for those past the end.
    #[inline(always)]
    pub fn to_regions(self, at: usize) -> [u8; LANES] {
        first_lanes(&self.by_region[at * LANES..])
    }

    /// Codes of the groups of a region; 0 for those past the end.
    #[inline(always)]
    pub fn to_groups(self, region: usize) -> [u8; LANES] {
        first_lanes(&self.by_group[region * LANES..])
    }

    /// Codes of the leaves of a group.
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
fn first_lanes(codes: &[u8]) -> [u8; LANES] {
    let mut padded = [0; LANES];
    match codes.first_chunk() {
        Some(full) => padded = *full,
        None => padded[..codes.len()].copy_from_slice(codes),
    }
    padded
}

/// The least code of a region's groups; sixteen, which almost all have, apart: that needs no loop.
#[inline(always)]
fn min_code(codes: &[u8]) -> u8 {
    match codes.first_chunk::<LANES>() {
        Some(full) => full.iter().copied().fold(u8::MAX, u8::min),
        None => codes.iter().copied().fold(u8::MAX, u8::min),
    }
}

/// The unit of codes, which reach two and a half times the standard deviation of all poses: beyond, the
/// exact distance does not matter.
fn code_step(frames: &[[f32; ROW_STRIDE]]) -> f32 {
    let n = frames.len() as f64;
    let variance: f64 = (0..POSE_DIM)
        .map(|i| {
            let values = || frames.iter().map(|row| f64::from(row[i]));
            let mean = values().sum::<f64>() / n;
            values().map(|v| (v - mean).powi(2)).sum::<f64>() / n
        })
        .sum();
    // For equal poses any step would do but 0.
    (variance.sqrt() as f32 * (2.5 / 255.0)).max(1e-20)
}

/// The order in which blocks take the frames, and the block of each. A few neighbours in time are
/// nearer to each other than what a k-d tree puts together, many are not.
fn assign_blocks(frames: &[[f32; ROW_STRIDE]], block: usize) -> (Vec<u32>, Vec<u32>) {
    let pose = |frame: &[f32; ROW_STRIDE]| -> [f32; POSE_DIM] { std::array::from_fn(|d| frame[d]) };
    let keys: Vec<_> = frames.iter().map(pose).collect();
    let mut order: Vec<u32> = (0..frames.len() as u32).collect();
    if block > MAX_BLOCK_BY_LEAF {
        tree::sort(&keys, &mut order, [block]);
    }
    let mut block_of = vec![0; frames.len()];
    for (at, &frame) in order.iter().enumerate() {
        block_of[frame as usize] = (at / block) as u32;
    }
    (order, block_of)
}

impl PoseBoxes {
    fn pack(leaves: &[PoseBounds]) -> Self {
        let corner = |of: fn(&PoseBounds) -> &[f32; POSE_DIM]| {
            std::array::from_fn(|d| std::array::from_fn(|lane| of(&leaves[lane])[d]))
        };
        PoseBoxes {
            low: corner(|leaf| &leaf.low),
            high: corner(|leaf| &leaf.high),
        }
    }

    /// Squared distances to the box from `least` to `greatest`. Leaves without rows are infinitely far
    /// away.
    #[inline(always)]
    fn squared_distances(&self, least: &[f32], greatest: &[f32]) -> [f32; LANES] {
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

/// Boxes around the poses of all leaves, by group.
fn leaf_boxes(tree: &KdTree) -> Vec<PoseBoxes> {
    let bounds: Vec<PoseBounds> = tree.leaves.par_iter().map(PoseBounds::of_leaf).collect();
    bounds.chunks(LANES).map(PoseBoxes::pack).collect()
}

/// The grid that encloses all poses.
fn pose_grid(frames: &[[f32; ROW_STRIDE]]) -> QuantisationGrid<POSE_DIM, POSE_PAIRS> {
    let PoseBounds { low, high } = PoseBounds::of_frames(frames);
    QuantisationGrid::enclosing(&low, &high)
}

fn quantise(
    grid: &QuantisationGrid<POSE_DIM, POSE_PAIRS>,
    boxes: &[PoseBoxes],
) -> Vec<QuantisedBoxes<POSE_PAIRS>> {
    let quantise = |boxes: &PoseBoxes| grid.quantise_boxes(&boxes.low, &boxes.high);
    boxes.iter().map(quantise).collect()
}

/// The box around some poses.
struct PoseBounds {
    low: [f32; POSE_DIM],
    high: [f32; POSE_DIM],
}

impl PoseBounds {
    fn empty() -> Self {
        PoseBounds {
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

    fn of_leaf(LeafRows(leaf): &LeafRows) -> Self {
        let mut bounds = Self::empty();
        for (dimension, lanes) in leaf.iter().enumerate().take(POSE_DIM) {
            lanes.iter().for_each(|&value| bounds.add(dimension, value));
        }
        bounds
    }

    fn of_frames(frames: &[[f32; ROW_STRIDE]]) -> Self {
        let mut bounds = Self::empty();
        for frame in frames {
            let pose = frame.iter().enumerate().take(POSE_DIM);
            pose.for_each(|(dimension, &value)| bounds.add(dimension, value));
        }
        bounds
    }
}

/// Codes of the least distances from a block of frames to every leaf of a group; if not `each_leaf`, only
/// the least of them has a meaning. Leaves whose box is too far from the frames' `bounds` are not looked
/// into: rounding errors there are far less than [`ROUND_DOWN`] allows.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
fn distance_codes(
    frames: &[[f32; ROW_STRIDE]],
    bounds: &PoseBounds,
    leaves: &[LeafRows],
    boxes: &PoseBoxes,
    step: f32,
    each_leaf: bool,
) -> [u8; LANES] {
    let apart = boxes.squared_distances(&bounds.low, &bounds.high);
    let mut nearest = [f32::INFINITY; LANES];
    let mut first = 0;
    for (lane, &other) in apart.iter().enumerate() {
        if other < apart[first] {
            first = lane;
        }
    }
    // Beyond, all codes are the same.
    let end = 255.0 / ROUND_DOWN * step * (1.0 + 1e-6);
    let mut limit = end * end;
    for round in 0..LANES {
        // The nearest box first, then the others in order.
        let lane = match round {
            0 => first,
            _ => round - usize::from(round <= first),
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
        if !each_leaf && nearest[lane] < limit {
            limit = nearest[lane];
        }
    }
    let mut codes = [0; LANES];
    for (code, nearest) in codes.iter_mut().zip(nearest) {
        // The cast stops at 255.
        *code = (nearest.sqrt() * ROUND_DOWN / step) as u8;
    }
    codes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::rng::{gaussian, random4};
    use crate::matching::pca::PrincipalAxes;

    /// Skipping leaves that are far apart changes no code.
    #[test]
    fn codes_are_those_of_comparing_all() {
        let frames: Vec<[f32; ROW_STRIDE]> = (0..3000)
            .map(|i| {
                // Ten bundles, so that many leaves are far apart.
                let bundle = i % 10;
                std::array::from_fn(|d| {
                    let centre = 3.0 * gaussian(random4(1, bundle, d as u32, 0));
                    centre + gaussian(random4(2, i, d as u32, 0))
                })
            })
            .collect();
        let tree = KdTree::build(&frames, &PrincipalAxes::of(&frames), None);
        let (groups, step) = (tree.leaf_boxes.len(), code_step(&frames));
        let whole = PoseBounds::of_frames(&frames);
        let everywhere = PoseBoxes {
            low: [[-1e9; LANES]; POSE_DIM],
            high: [[1e9; LANES]; POSE_DIM],
        };
        for memory in [1 << 30, 0] {
            let table = PoseDistanceTable::build(&frames, &tree, memory);
            assert_eq!(table.by_leaf.is_empty(), memory == 0);
            for (block, by_group) in table.by_group.chunks(groups).enumerate() {
                let of_block = |&at: &usize| table.block_of[at] as usize == block;
                let inside: Vec<_> = (0..frames.len()).filter(of_block).collect();
                let inside: Vec<_> = inside.into_iter().map(|at| frames[at]).collect();
                for (group, &code) in by_group.iter().enumerate() {
                    let leaves = &tree.leaves[group * LANES..][..LANES];
                    let plain = distance_codes(&inside, &whole, leaves, &everywhere, step, true);
                    assert_eq!(Some(&code), plain.iter().min());
                    if let Some(by_leaf) = table.by_leaf.get(block * groups + group) {
                        assert_eq!(*by_leaf, plain);
                    }
                }
            }
        }
    }
}
