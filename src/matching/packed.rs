//! The index as the shaders `search_near`, `search_reach` and `search_leaves` read it.

use super::Index;
use super::tree::{Corners, LANES};
use crate::motion::database::ROW_STRIDE;
use crate::motion::features::{FEATURE_DIM, TRAJECTORY_DIM};

/// Arrays for the device; shapes as in `shaders/search`.
pub struct Packed {
    /// `[leaves * LANES][ROW_STRIDE]`
    pub rows: Vec<[f32; ROW_STRIDE]>,
    /// `[leaves * LANES][ROW_STRIDE]`
    pub coarse: Vec<[u8; ROW_STRIDE]>,
    /// `[12 + 2 * (groups + leaves)][TRAJECTORY_DIM]`
    pub boxes: Vec<[f32; TRAJECTORY_DIM]>,
    /// The block of every frame, as words; bytes: `[blocks][groups]`, padded to whole words, then
    /// `[blocks][leaves]` if there are any.
    pub codes: Vec<u8>,
    /// Frames: word of `codes` where those of the groups begin.
    pub frames: u32,
    /// Word where those of the leaves begin; 0 if there are none.
    pub leaf_codes: u32,
    pub groups: u32,
    /// Distance a unit of a byte of `codes`.
    pub step: f32,
    /// Length of the longest trajectory.
    pub longest: f32,
    /// Bytes of `coarse` stand for numbers from `-range` to `range`.
    pub range: f32,
    /// How far rounding to bytes moves a row at most.
    pub blur: f32,
}

impl Packed {
    pub fn of(index: &Index) -> Self {
        let (tree, poses) = (&index.tree, &index.poses);
        let mut boxes = index.axes.rows().to_vec();
        for (outer, groups) in tree.outer.iter().zip(tree.inner.chunks(LANES)) {
            for lane in 0..groups.len() {
                boxes.extend([corner(&outer.low, lane), corner(&outer.high, lane)]);
            }
        }
        for inner in &tree.inner {
            for lane in 0..LANES {
                boxes.extend([&inner.low, &inner.high].map(|of| tree.grid.corner(of, lane)));
            }
        }
        let mut codes = bytemuck::cast_slice(&poses.block_of).to_vec();
        codes.extend(super::padded(&poses.by_group));
        let leaf_codes = match poses.by_leaf.is_empty() {
            true => 0,
            false => codes.len() as u32 / 4,
        };
        codes.extend(poses.by_leaf.as_flattened());
        let rows = rows(index);
        let range = range(&rows);
        let coarse: Vec<_> = rows.iter().map(|row| round(row, range)).collect();
        let moved = rows
            .iter()
            .zip(&coarse)
            .map(|(row, bytes)| moved(row, bytes, range));
        Packed {
            // Half a byte's step is the most a number moves; what the shader rounds is far less than
            // the thousandth added here.
            blur: 1.001 * moved.fold(0.0, f32::max) + 1e-4 * range,
            range,
            rows,
            coarse,
            boxes,
            codes,
            leaf_codes,
            groups: tree.inner.len() as u32,
            frames: poses.block_of.len() as u32,
            step: poses.shape.step,
            longest: index.longest,
        }
    }
}

/// Shaders need not know infinity.
fn corner(corners: &Corners, lane: usize) -> [f32; TRAJECTORY_DIM] {
    corners.map(|lanes| lanes[lane].min(1e18))
}

/// Where a leaf has no row, the first one of all again: it changes no answer.
fn rows(index: &Index) -> Vec<[f32; ROW_STRIDE]> {
    let tree = &index.tree;
    let row = |leaf: usize, lane: usize| -> [f32; ROW_STRIDE] {
        std::array::from_fn(|d| match d {
            0..FEATURE_DIM => tree.leaves[leaf].0[d][lane],
            _ => tree.ids[leaf][lane] as f32,
        })
    };
    let first = row(0, 0);
    let places = (0..tree.leaves.len()).flat_map(|leaf| (0..LANES).map(move |lane| (leaf, lane)));
    places
        .map(|(leaf, lane)| match tree.ids[leaf][lane] {
            u32::MAX => first,
            _ => row(leaf, lane),
        })
        .collect()
}

/// Three deviations of the dimension that varies most: what lies beyond is cut off.
fn range(rows: &[[f32; ROW_STRIDE]]) -> f32 {
    let n = rows.len() as f64;
    let variance = |d: usize| {
        let values = || rows.iter().map(|row| f64::from(row[d]));
        let mean = values().sum::<f64>() / n;
        values().map(|v| (v - mean).powi(2)).sum::<f64>() / n
    };
    let most = (0..FEATURE_DIM).map(variance).fold(0.0, f64::max);
    // Of equal rows any range would do but 0.
    (3.0 * most.sqrt() as f32).max(1e-15)
}

/// From 0 to 255.
fn place(value: f32, range: f32) -> f32 {
    (value / (2.0 * range) + 0.5).clamp(0.0, 1.0) * 255.0
}

fn round(row: &[f32; ROW_STRIDE], range: f32) -> [u8; ROW_STRIDE] {
    std::array::from_fn(|d| match d {
        0..FEATURE_DIM => place(row[d], range).round() as u8,
        _ => 0,
    })
}

/// How far a row was moved by rounding, not by cutting.
fn moved(row: &[f32; ROW_STRIDE], bytes: &[u8; ROW_STRIDE], range: f32) -> f32 {
    let each = row.iter().zip(bytes).take(FEATURE_DIM);
    let moved = each.map(|(&value, &byte)| (place(value, range) - f32::from(byte)).powi(2));
    moved.sum::<f32>().sqrt() * (2.0 * range / 255.0)
}
