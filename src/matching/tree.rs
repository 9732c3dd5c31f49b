//! The rows, sorted so that near ones are stored together: a balanced k-d tree's leaves of sixteen rows
//! ([`LANES`]), sixteen leaves a group, sixteen groups a region.

use super::pca::PrincipalAxes;
use super::quantised_boxes::{LANES, QuantisationGrid, QuantisedBoxes, TRAJECTORY_PAIRS};
use crate::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE, TRAJECTORY_DIM};
use rayon::prelude::*;

/// Rows of a region, a group and a leaf.
const SIZES: [usize; 3] = [LANES * LANES * LANES, LANES * LANES, LANES];
/// Weight of the pose in how rows are sorted. Poses are bounded by a table in whatever order, so it is
/// the boxes of the trajectories that should be small.
const POSE_WEIGHT: f32 = 0.5;

/// Sixteen feature rows, dimension by dimension. Lanes without a row hold infinity: never nearest.
/// Sixteen numbers fill a cache line, and none crosses two.
#[repr(align(64))]
#[derive(Clone, Copy)]
pub struct LeafRows(pub [[f32; LANES]; FEATURE_DIM]);
/// Corners of sixteen boxes, axis by axis.
pub type TrajectoryCorners = [[f32; LANES]; TRAJECTORY_DIM];

/// Sixteen boxes around trajectories, along the principal axes.
#[repr(align(64))]
pub struct TrajectoryBoxes {
    pub low: TrajectoryCorners,
    pub high: TrajectoryCorners,
}

pub struct KdTree {
    /// `[groups * LANES]`
    pub leaves: Vec<LeafRows>,
    /// Original index of every row of every leaf.
    pub ids: Vec<[u32; LANES]>,
    /// Grid of the boxes of the leaves.
    pub grid: QuantisationGrid<TRAJECTORY_DIM, TRAJECTORY_PAIRS>,
    /// Boxes of the leaves, by group.
    pub leaf_boxes: Vec<QuantisedBoxes<TRAJECTORY_PAIRS>>,
    /// Boxes of the groups, by region.
    pub group_boxes: Vec<TrajectoryBoxes>,
    /// Boxes of the regions, sixteen at a time.
    pub region_boxes: Vec<TrajectoryBoxes>,
}

/// What rows are sorted by: the weighted pose, then the trajectory along the principal axes, of which
/// their boxes are made.
type SortKey = [f32; FEATURE_DIM];
/// One box: its lower and its upper corner.
type TrajectoryBox = [[f32; TRAJECTORY_DIM]; 2];
/// The box around no point.
const EMPTY: TrajectoryBox = [
    [f32::INFINITY; TRAJECTORY_DIM],
    [f32::NEG_INFINITY; TRAJECTORY_DIM],
];

impl KdTree {
    /// The tree of `rows`, of which there must be at least one; `order` is that of an earlier tree of the
    /// same rows, to save the sorting.
    pub fn build(
        rows: &[[f32; ROW_STRIDE]],
        axes: &PrincipalAxes,
        order: Option<Vec<u32>>,
    ) -> Self {
        let key = |row: &[f32; ROW_STRIDE]| -> SortKey {
            let projected = axes.project(row);
            std::array::from_fn(|d| match d {
                0..POSE_DIM => POSE_WEIGHT * row[d],
                _ => projected[d - POSE_DIM],
            })
        };
        let keys: Vec<SortKey> = rows.par_iter().map(key).collect();
        let order = order.unwrap_or_else(|| {
            let mut order: Vec<u32> = (0..rows.len() as u32).collect();
            sort(&keys, &mut order, SIZES);
            order
        });
        let groups = rows.len().div_ceil(LANES * LANES);
        let mut leaves = vec![LeafRows([[f32::INFINITY; LANES]; FEATURE_DIM]); groups * LANES];
        let mut ids = vec![[u32::MAX; LANES]; groups * LANES];
        let mut boxes = vec![EMPTY; groups * LANES];
        for (at, &id) in order.iter().enumerate() {
            let (leaf, lane) = (at / LANES, at % LANES);
            ids[leaf][lane] = id;
            for (lanes, value) in leaves[leaf].0.iter_mut().zip(rows[id as usize]) {
                lanes[lane] = value;
            }
            let trajectory = &keys[id as usize][POSE_DIM..];
            let trajectory = std::array::from_fn(|axis| trajectory[axis]);
            boxes[leaf] = union(boxes[leaf], [trajectory, trajectory]);
        }
        let groups = parents(&boxes);
        let regions = parents(&groups);
        let [low, high] = regions.iter().copied().fold(EMPTY, union);
        let grid = QuantisationGrid::enclosing(&low, &high);
        let boxes = boxes.chunks(LANES).map(pack);
        KdTree {
            leaves,
            ids,
            leaf_boxes: boxes
                .map(|of| grid.quantise_boxes(&of.low, &of.high))
                .collect(),
            grid,
            group_boxes: groups.chunks(LANES).map(pack).collect(),
            region_boxes: regions.chunks(LANES).map(pack).collect(),
        }
    }

    /// Original indices of all rows, leaf by leaf.
    pub fn order(&self) -> Vec<u32> {
        let ids = self.ids.iter().flatten().copied();
        ids.filter(|&id| id != u32::MAX).collect()
    }

    /// Bytes of memory held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.leaves[..])
            + size_of_val(&self.ids[..])
            + size_of_val(&self.leaf_boxes[..])
            + size_of_val(&self.group_boxes[..])
            + size_of_val(&self.region_boxes[..])
    }
}

/// Splits at the median of the widest dimension until the least of the falling `sizes` is left. Halves
/// hold as many full units of the largest size of which there is more than one, so that all but the last
/// are full subtrees.
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
fn parents(boxes: &[TrajectoryBox]) -> Vec<TrajectoryBox> {
    let each = boxes.chunks(LANES);
    each.map(|children| children.iter().copied().fold(EMPTY, union))
        .collect()
}

/// The box around two boxes.
fn union([low, high]: TrajectoryBox, [other_low, other_high]: TrajectoryBox) -> TrajectoryBox {
    [
        std::array::from_fn(|axis| low[axis].min(other_low[axis])),
        std::array::from_fn(|axis| high[axis].max(other_high[axis])),
    ]
}

/// Sixteen boxes axis by axis. Lanes without a box are infinitely far away, and so are empty boxes.
fn pack(boxes: &[TrajectoryBox]) -> TrajectoryBoxes {
    let lanes = |corner: usize| -> TrajectoryCorners {
        let value = |lane: usize, axis: usize| match boxes.get(lane) {
            Some(of) if of[0][axis] < f32::INFINITY => of[corner][axis],
            _ => f32::INFINITY,
        };
        std::array::from_fn(|axis| std::array::from_fn(|lane| value(lane, axis)))
    };
    TrajectoryBoxes {
        low: lanes(0),
        high: lanes(1),
    }
}
