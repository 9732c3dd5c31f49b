//! The rows, sorted so that near ones lie together: a balanced k-d tree's leaves of sixteen rows,
//! sixteen leaves a group, sixteen groups a region.

use super::pca::Axes;
use super::quantised_boxes::{Grid, Rounded, TRAJECTORY_PAIRS};
use crate::motion::database::ROW_STRIDE;
use crate::motion::features::{FEATURE_DIM, POSE_DIM, TRAJECTORY_DIM};
use rayon::prelude::*;

/// Rows a leaf, leaves a group, groups a region: the width of the widest vector registers.
pub const LANES: usize = 16;
/// Rows of a region, a group and a leaf.
const SIZES: [usize; 3] = [LANES * LANES * LANES, LANES * LANES, LANES];
/// The pose's share in how rows are sorted. Poses are bounded by a table however they lie, so it
/// is the boxes of the trajectories that should be small.
const POSE_SHARE: f32 = 0.5;

/// Sixteen feature rows, dimension by dimension. Lanes without a row hold infinity: never nearest.
/// Sixteen numbers fill a line of a cache, and none lies across two.
#[repr(align(64))]
#[derive(Clone, Copy)]
pub struct Lanes(pub [[f32; LANES]; FEATURE_DIM]);
/// Corners of sixteen boxes, axis by axis.
pub type Corners = [[f32; LANES]; TRAJECTORY_DIM];

/// Sixteen boxes around trajectories, along the principal axes.
#[repr(align(64))]
pub struct Boxes {
    pub low: Corners,
    pub high: Corners,
}

pub struct Tree {
    /// `[groups * LANES]`
    pub leaves: Vec<Lanes>,
    /// Original index of every row of every leaf.
    pub ids: Vec<[u32; LANES]>,
    /// Of the boxes of the leaves.
    pub grid: Grid<TRAJECTORY_DIM, TRAJECTORY_PAIRS>,
    /// Boxes of the leaves, by group.
    pub inner: Vec<Rounded<TRAJECTORY_PAIRS>>,
    /// Boxes of the groups, by region.
    pub outer: Vec<Boxes>,
    /// Boxes of the regions, sixteen at a time.
    pub regions: Vec<Boxes>,
}

/// What rows are sorted by, and behind it what their boxes are made of.
type Key = [f32; FEATURE_DIM];
/// One box: its lower and its upper corner.
type Corner = [[f32; TRAJECTORY_DIM]; 2];
/// A box around nothing.
const NOTHING: Corner = [[f32::INFINITY; TRAJECTORY_DIM], [f32::NEG_INFINITY; TRAJECTORY_DIM]];

impl Tree {
    /// Of `rows`, of which there must be at least one; `order` is that of an earlier tree of the same
    /// rows, to save the sorting.
    pub fn of(rows: &[[f32; ROW_STRIDE]], axes: &Axes, order: Option<Vec<u32>>) -> Self {
        let key = |row: &[f32; ROW_STRIDE]| -> Key {
            let turned = axes.turn(row);
            std::array::from_fn(|d| match d {
                0..POSE_DIM => POSE_SHARE * row[d],
                _ => turned[d - POSE_DIM],
            })
        };
        let keys: Vec<Key> = rows.par_iter().map(key).collect();
        let order = order.unwrap_or_else(|| {
            let mut order: Vec<u32> = (0..rows.len() as u32).collect();
            sort(&keys, &mut order, SIZES);
            order
        });
        let groups = rows.len().div_ceil(LANES * LANES);
        let mut leaves = vec![Lanes([[f32::INFINITY; LANES]; FEATURE_DIM]); groups * LANES];
        let mut ids = vec![[u32::MAX; LANES]; groups * LANES];
        let mut corners = vec![NOTHING; groups * LANES];
        for (at, &id) in order.iter().enumerate() {
            let (leaf, lane) = (at / LANES, at % LANES);
            ids[leaf][lane] = id;
            for (lanes, value) in leaves[leaf].0.iter_mut().zip(rows[id as usize]) {
                lanes[lane] = value;
            }
            let place = &keys[id as usize][POSE_DIM..];
            let place = std::array::from_fn(|axis| place[axis]);
            corners[leaf] = around(corners[leaf], [place, place]);
        }
        let groups = joined(&corners);
        let regions = joined(&groups);
        let [low, high] = regions.iter().copied().fold(NOTHING, around);
        let grid = Grid::around(&low, &high);
        let boxes = corners.chunks(LANES).map(pack);
        Tree {
            leaves,
            ids,
            inner: boxes.map(|of| grid.widen(&of.low, &of.high)).collect(),
            grid,
            outer: groups.chunks(LANES).map(pack).collect(),
            regions: regions.chunks(LANES).map(pack).collect(),
        }
    }

    /// All rows, leaf by leaf.
    pub fn order(&self) -> Vec<u32> {
        let ids = self.ids.iter().flatten().copied();
        ids.filter(|&id| id != u32::MAX).collect()
    }

    pub fn bytes(&self) -> usize {
        size_of_val(&self.leaves[..])
            + size_of_val(&self.ids[..])
            + size_of_val(&self.inner[..])
            + size_of_val(&self.outer[..])
            + size_of_val(&self.regions[..])
    }
}

/// Splits at the median of the widest dimension until the least of the falling `sizes` is left. Halves
/// hold as many whole ones of the largest size there is more than one of, so that all but the last are
/// full, and subtrees.
pub fn sort<const D: usize, const N: usize>(
    keys: &[[f32; D]],
    order: &mut [u32],
    sizes: [usize; N],
) {
    let Some(unit) = sizes.into_iter().find(|&size| order.len() > size) else {
        // Ascending ids: the first of equals in a leaf has the lowest.
        order.sort_unstable();
        return;
    };
    let middle = (order.len().div_ceil(unit) / 2) * unit;
    let dimension = widest(keys, order);
    order.select_nth_unstable_by(middle, |&a, &b| {
        keys[a as usize][dimension]
            .total_cmp(&keys[b as usize][dimension])
            .then(a.cmp(&b))
    });
    let (left, right) = order.split_at_mut(middle);
    rayon::join(|| sort(keys, left, sizes), || sort(keys, right, sizes));
}

/// The dimension of the largest variance.
fn widest<const D: usize>(keys: &[[f32; D]], order: &[u32]) -> usize {
    let (mut sum, mut square) = ([0.0f64; D], [0.0f64; D]);
    for &id in order {
        for dimension in 0..D {
            let value = f64::from(keys[id as usize][dimension]);
            sum[dimension] += value;
            square[dimension] += value * value;
        }
    }
    let n = order.len() as f64;
    let variance = |d: usize| square[d] - sum[d] * sum[d] / n;
    (0..D)
        .max_by(|&a, &b| variance(a).total_cmp(&variance(b)))
        .unwrap_or(0)
}

/// The boxes around sixteen boxes each.
fn joined(corners: &[Corner]) -> Vec<Corner> {
    let each = corners.chunks(LANES);
    each.map(|of| of.iter().copied().fold(NOTHING, around))
        .collect()
}

/// The box around two boxes.
fn around([low, high]: Corner, [other_low, other_high]: Corner) -> Corner {
    [
        std::array::from_fn(|axis| low[axis].min(other_low[axis])),
        std::array::from_fn(|axis| high[axis].max(other_high[axis])),
    ]
}

/// Lanes without a box are infinitely far away, and so are boxes around nothing.
fn pack(corners: &[Corner]) -> Boxes {
    let lanes = |corner: usize| -> Corners {
        let value = |lane: usize, axis: usize| match corners.get(lane) {
            Some(of) if of[0][axis] < f32::INFINITY => of[corner][axis],
            _ => f32::INFINITY,
        };
        std::array::from_fn(|axis| std::array::from_fn(|lane| value(lane, axis)))
    };
    Boxes {
        low: lanes(0),
        high: lanes(1),
    }
}
