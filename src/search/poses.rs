//! How near the poses of the database come to each other: a query's pose half is always a row of
//! the database itself, so how far it is from every leaf's poses is known before it is asked.
//!
//! For every block of neighbouring frames and every leaf, and every group of leaves: the least
//! distance from any pose of the one to any pose of the other, rounded down to a byte.

use super::tree::{LANES, Lanes, Tree};
use crate::motion::database::PADDED;
use crate::motion::features::POSE;
use multiversion::multiversion;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

pub struct Poses {
    pub shape: Shape,
    /// `[blocks][groups]`
    pub by_group: Vec<u8>,
    /// `[blocks][groups][LANES]`; empty where memory was short.
    pub by_leaf: Vec<[u8; LANES]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Frames a block.
    pub block: usize,
    groups: usize,
    /// Distance a step of a code.
    pub step: f32,
}

/// Frames a block, from the tightest on.
const BLOCKS: [usize; 6] = [4, 8, 16, 32, 64, 128];
/// The largest blocks that are worth a code for every leaf.
const BY_LEAF: usize = 16;
/// Keeps a code's distance below the true one whatever was rounded on the way.
const DOWN: f32 = 1.0 - 1e-5;

impl Poses {
    /// From all `frames` to the rows of `tree`, in at most `memory` bytes; if the coarsest table
    /// needs more, in that.
    pub fn of(frames: &[[f32; PADDED]], tree: &Tree, memory: usize) -> Self {
        let groups = tree.inner.len();
        let find = |codes: usize| {
            let fits = |&block: &usize| frames.len().div_ceil(block) * groups * codes <= memory;
            BLOCKS.into_iter().find(fits)
        };
        let (block, lanes) = match find(LANES + 1) {
            Some(block) if block <= BY_LEAF => (block, LANES),
            _ => (find(1).unwrap_or(BLOCKS[BLOCKS.len() - 1]), 0),
        };
        let blocks = frames.len().div_ceil(block);
        let step = step(frames);
        let mut poses = Poses {
            shape: Shape {
                block,
                groups,
                step,
            },
            by_group: vec![0; blocks * groups],
            by_leaf: vec![[0; LANES]; blocks * groups * lanes / LANES],
        };
        let boxes: Vec<Around> = tree.leaves.par_iter().map(Around::leaf).collect();
        let fine = lanes > 0;
        let mut by_leaf: Vec<&mut [[u8; LANES]]> = poses.by_leaf.chunks_mut(groups).collect();
        by_leaf.resize_with(blocks, || &mut []);
        frames
            .par_chunks(block)
            .zip(poses.by_group.par_chunks_mut(groups))
            .zip(by_leaf)
            .for_each(|((frames, by_group), by_leaf)| {
                let around = Around::frames(frames);
                for (group, least) in by_group.iter_mut().enumerate() {
                    let leaves = &tree.leaves[group * LANES..][..LANES];
                    let apart = around.apart(&boxes[group * LANES..][..LANES]);
                    let codes = codes(frames, leaves, &apart, step, fine);
                    *least = codes.into_iter().fold(u8::MAX, u8::min);
                    if let Some(kept) = by_leaf.get_mut(group) {
                        *kept = codes;
                    }
                }
            });
        poses
    }

    /// Of a file, where the codes of the groups are padded to whole words; `None` if these
    /// numbers cannot be of so many frames and groups.
    pub fn restored(
        shape: Shape,
        mut by_group: Vec<u8>,
        by_leaf: Vec<[u8; LANES]>,
        frames: usize,
        groups: usize,
    ) -> Option<Self> {
        if shape.block == 0 || shape.groups != groups {
            return None;
        }
        let codes = frames.div_ceil(shape.block) * groups;
        let fits = by_group.len() == codes.next_multiple_of(4)
            && (by_leaf.is_empty() || by_leaf.len() == codes);
        by_group.truncate(codes);
        fits.then_some(Poses {
            shape,
            by_group,
            by_leaf,
        })
    }

    pub fn bytes(&self) -> usize {
        self.by_group.len() + self.by_leaf.len() * LANES
    }

    /// What is known of one frame's pose.
    #[inline(always)]
    pub fn row(&self, frame: u32) -> Row<'_> {
        let Shape {
            block,
            groups,
            step,
        } = self.shape;
        let first = frame as usize / block * groups;
        Row {
            by_group: &self.by_group[first..][..groups],
            by_leaf: self.by_leaf.get(first..first + groups),
            step,
        }
    }
}

/// Lower bounds of one frame's squared distances to the poses of all leaves.
#[derive(Clone, Copy)]
pub struct Row<'a> {
    by_group: &'a [u8],
    by_leaf: Option<&'a [[u8; LANES]]>,
    step: f32,
}

impl Row<'_> {
    /// To sixteen groups, from a multiple of sixteen on; 0 for those past the end.
    #[inline(always)]
    pub fn to_groups(self, first: usize) -> [f32; LANES] {
        let codes = &self.by_group[first..];
        let mut padded = [0; LANES];
        match codes.first_chunk() {
            Some(full) => padded = *full,
            None => padded[..codes.len()].copy_from_slice(codes),
        }
        self.squares(padded)
    }

    /// To the leaves of a group.
    #[inline(always)]
    pub fn to_leaves(self, group: usize) -> [f32; LANES] {
        match self.by_leaf {
            Some(codes) => self.squares(codes[group]),
            None => self.squares([self.by_group[group]; LANES]),
        }
    }

    #[inline(always)]
    fn squares(self, codes: [u8; LANES]) -> [f32; LANES] {
        codes.map(|code| {
            let distance = f32::from(code) * self.step;
            distance * distance
        })
    }
}

/// Codes reach two and a half times the deviation of all poses: beyond, they need not tell how far.
fn step(frames: &[[f32; PADDED]]) -> f32 {
    let n = frames.len() as f64;
    let variance: f64 = (0..POSE)
        .map(|i| {
            let values = || frames.iter().map(|row| f64::from(row[i]));
            let mean = values().sum::<f64>() / n;
            values().map(|v| (v - mean).powi(2)).sum::<f64>() / n
        })
        .sum();
    // Of equal poses any step would do but 0.
    (variance.sqrt() as f32 * (2.5 / 255.0)).max(1e-20)
}

/// The box around some poses.
struct Around {
    low: [f32; POSE],
    high: [f32; POSE],
}

impl Around {
    fn nothing() -> Self {
        Around {
            low: [f32::INFINITY; POSE],
            high: [f32::NEG_INFINITY; POSE],
        }
    }

    fn add(&mut self, dimension: usize, value: f32) {
        // Lanes without a row hold infinity.
        if value < f32::INFINITY {
            self.low[dimension] = self.low[dimension].min(value);
            self.high[dimension] = self.high[dimension].max(value);
        }
    }

    fn leaf(leaf: &Lanes) -> Self {
        let mut around = Self::nothing();
        for (dimension, lanes) in leaf.iter().enumerate().take(POSE) {
            lanes.iter().for_each(|&value| around.add(dimension, value));
        }
        around
    }

    fn frames(frames: &[[f32; PADDED]]) -> Self {
        let mut around = Self::nothing();
        for frame in frames {
            let pose = frame.iter().enumerate().take(POSE);
            pose.for_each(|(dimension, &value)| around.add(dimension, value));
        }
        around
    }

    /// Squared distances to the boxes around sixteen leaves: no pose of the one is nearer to a pose
    /// of the other.
    fn apart(&self, leaves: &[Around]) -> [f32; LANES] {
        let mut apart = [0.0; LANES];
        for (apart, leaf) in apart.iter_mut().zip(leaves) {
            for dimension in 0..POSE {
                let below = leaf.low[dimension] - self.high[dimension];
                let above = self.low[dimension] - leaf.high[dimension];
                let outside = below.max(above).max(0.0);
                *apart += outside * outside;
            }
        }
        apart
    }
}

/// Of every leaf of a group; if not `fine`, only the least of them has a meaning. Leaves too far
/// `apart` to matter are not looked into: an error of rounding there is far less than [`DOWN`] allows.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
fn codes(
    frames: &[[f32; PADDED]],
    leaves: &[Lanes],
    apart: &[f32; LANES],
    step: f32,
    fine: bool,
) -> [u8; LANES] {
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
            for (&value, lanes) in frame.iter().zip(&leaves[lane][..POSE]) {
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
