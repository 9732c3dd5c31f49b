//! The index as the shaders `search_seed`, `search_prune` and `search_leaves` read it.

use crate::matching::index::{Index, pad_to_words};
use crate::matching::quantised_boxes::LANES;
use crate::matching::tree::TrajectoryCorners;
use crate::motion::features::{FEATURE_DIM, ROW_STRIDE, TRAJECTORY_DIM};

/// Arrays for the device; shapes as in `shaders/search`.
pub struct PackedIndex {
    /// `[leaves * LANES][ROW_STRIDE]`; the last number is the candidate.
    pub rows: Vec<[f32; ROW_STRIDE]>,
    /// The rows in bytes, `[leaves * LANES][ROW_STRIDE]`.
    pub quantised_rows: Vec<[u8; ROW_STRIDE]>,
    /// The principal axes, then the corners of the boxes of groups and leaves:
    /// `[12 + 2 * (groups + leaves)][TRAJECTORY_DIM]`.
    pub boxes: Vec<[f32; TRAJECTORY_DIM]>,
    /// The block of every frame, as words; bytes: `[blocks][groups]`, padded to whole words, then
    /// `[blocks][leaves]` if there are any.
    pub distance_codes: Vec<u8>,
    /// Frames: word of `distance_codes` where those of the groups begin.
    pub frames: u32,
    /// Word where those of the leaves begin; 0 if there are none.
    pub leaf_codes: u32,
    /// Groups of sixteen leaves.
    pub groups: u32,
    /// Distance a unit of a byte of `distance_codes`.
    pub step: f32,
    /// Norm of the max_norm trajectory.
    pub max_norm: f32,
    /// Bytes of `quantised_rows` stand for numbers from `-range` to `range`.
    pub range: f32,
    /// Distance by which rounding to bytes moves a row at most.
    pub quantisation_error: f32,
}

impl PackedIndex {
    /// Lays out an index for the device.
    pub fn of(index: &Index) -> Self {
        let (tree, poses) = (&index.tree, &index.poses);
        let mut boxes = index.axes.rows().to_vec();
        for (outer, groups) in tree.group_boxes.iter().zip(tree.leaf_boxes.chunks(LANES)) {
            for lane in 0..groups.len() {
                boxes.extend([corner(&outer.low, lane), corner(&outer.high, lane)]);
            }
        }
        for leaves in &tree.leaf_boxes {
            for lane in 0..LANES {
                boxes.extend([&leaves.low, &leaves.high].map(|of| tree.grid.corner(of, lane)));
            }
        }
        let mut distance_codes = bytemuck::cast_slice(&poses.block_of).to_vec();
        distance_codes.extend(pad_to_words(&poses.by_group));
        let leaf_codes = match poses.by_leaf.is_empty() {
            true => 0,
            false => distance_codes.len() as u32 / 4,
        };
        distance_codes.extend(poses.by_leaf.as_flattened());
        let rows = rows(index);
        let range = range(&rows);
        let quantised_rows: Vec<_> = rows.iter().map(|row| quantise(row, range)).collect();
        let errors = rows
            .iter()
            .zip(&quantised_rows)
            .map(|(row, bytes)| error(row, bytes, range));
        PackedIndex {
            // Half a byte's step is the most a number moves; what the shader rounds is far less than
            // the thousandth added here.
            quantisation_error: 1.001 * errors.fold(0.0, f32::max) + 1e-4 * range,
            range,
            rows,
            quantised_rows,
            boxes,
            distance_codes,
            leaf_codes,
            groups: tree.leaf_boxes.len() as u32,
            frames: poses.block_of.len() as u32,
            step: poses.layout.step,
            max_norm: index.max_norm,
        }
    }
}

/// A corner of a box, finite: shaders need not know infinity.
fn corner(corners: &TrajectoryCorners, lane: usize) -> [f32; TRAJECTORY_DIM] {
    corners.map(|lanes| lanes[lane].min(1e18))
}

/// All rows, leaf by leaf. Where a leaf has no row, the first one of all again: it changes no result.
fn rows(index: &Index) -> Vec<[f32; ROW_STRIDE]> {
    let tree = &index.tree;
    let row = |leaf: usize, lane: usize| -> [f32; ROW_STRIDE] {
        std::array::from_fn(|d| match d {
            0..FEATURE_DIM => tree.leaves[leaf].0[d][lane],
            _ => tree.ids[leaf][lane] as f32,
        })
    };
    let first = row(0, 0);
    let slots = (0..tree.leaves.len()).flat_map(|leaf| (0..LANES).map(move |lane| (leaf, lane)));
    slots
        .map(|(leaf, lane)| match tree.ids[leaf][lane] {
            u32::MAX => first,
            _ => row(leaf, lane),
        })
        .collect()
}

/// Three standard deviations of the dimension that varies most: what is beyond is clipped.
fn range(rows: &[[f32; ROW_STRIDE]]) -> f32 {
    let n = rows.len() as f64;
    let variance = |d: usize| {
        let values = || rows.iter().map(|row| f64::from(row[d]));
        let mean = values().sum::<f64>() / n;
        values().map(|v| (v - mean).powi(2)).sum::<f64>() / n
    };
    let most = (0..FEATURE_DIM).map(variance).fold(0.0, f64::max);
    // For equal rows any range would do but 0.
    (3.0 * most.sqrt() as f32).max(1e-15)
}

/// A number in units of bytes, from 0 to 255.
fn to_byte(value: f32, range: f32) -> f32 {
    (value / (2.0 * range) + 0.5).clamp(0.0, 1.0) * 255.0
}

fn quantise(row: &[f32; ROW_STRIDE], range: f32) -> [u8; ROW_STRIDE] {
    std::array::from_fn(|d| match d {
        0..FEATURE_DIM => to_byte(row[d], range).round() as u8,
        _ => 0,
    })
}

/// Distance by which a row was moved by rounding, not by clipping.
fn error(row: &[f32; ROW_STRIDE], bytes: &[u8; ROW_STRIDE], range: f32) -> f32 {
    let each = row.iter().zip(bytes).take(FEATURE_DIM);
    let squares = each.map(|(&value, &byte)| (to_byte(value, range) - f32::from(byte)).powi(2));
    squares.sum::<f32>().sqrt() * (2.0 * range / 255.0)
}
