//! Exact nearest-row search on the CPU: all cores over the queries, sixteen rows at a time, and
//! most rows left unread because a lower bound says that they cannot be nearest ([`batch`]).
//!
//! The bound of a leaf is the least distance of its poses to the query's, which is known
//! beforehand ([`pose_distance_table`]), and the distance of the query's trajectory to the box around the leaf's
//! along the principal axes ([`pca`], [`tree`], [`quantised_boxes`]). Bounds are widened by more than rounding can do,
//! and distances are those of [`crate::kernels::search::search_exact::squared`]: the answer is, bit for
//! bit, that of [`crate::kernels::search::search_exact::twin`], the lowest index of equals included.

mod pca;
mod batch;
mod quantised_boxes;
mod packed;
mod pose_distance_table;
mod tree;

use crate::motion::database::ROW_STRIDE;
use crate::motion::features::{FEATURE_DIM, POSE_DIM};
use crate::container::{Arrays, Format, StoreError};
use axes::Axes;
pub use packed::Packed;
use poses::{Poses, Shape};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::Path;
use tree::Tree;

/// Queries that a task of the thread pool answers together, at least and at most: what one of them has
/// fetched from memory serves the others. In between, so many that each has to fetch [`SHARE`] bytes.
const TASK: [usize; 2] = [16, 4096];
const SHARE: usize = 1 << 15;
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
    pub fn build(frames: &[[f32; ROW_STRIDE]], candidates: &[u32], memory: usize) -> Self {
        let rows: Vec<_> = candidates.iter().map(|&at| frames[at as usize]).collect();
        let axes = Axes::of(&rows);
        let tree = Tree::of(&rows, &axes, None);
        let poses = Poses::of(frames, &tree, memory);
        Self::join(&rows, axes, tree, poses)
    }

    fn join(rows: &[[f32; ROW_STRIDE]], axes: Axes, tree: Tree, poses: Poses) -> Self {
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
        crate::container::save(path, FORMAT, &header, &arrays)
    }

    /// Reads a file written by [`Index::save`]; `None` if there is none, or none of this database
    /// (`fingerprint`) in this form: then it must be built.
    pub fn load(
        path: &Path,
        fingerprint: u32,
        frames: &[[f32; ROW_STRIDE]],
        candidates: &[u32],
    ) -> Option<Self> {
        let (header, mut arrays) = crate::container::load::<Header>(path, FORMAT).ok()?;
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
    pub fn nearest(&self, frame: u32, query: &[f32; ROW_STRIDE]) -> Nearest {
        let mut found = [Nearest::NONE];
        batch::nearest(self, &[frame], &[*query], &mut found);
        found[0]
    }

    /// Nearest candidate of every query, on all cores.
    pub fn nearest_all(&self, frames: &[u32], queries: &[[f32; ROW_STRIDE]], found: &mut [u32]) {
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
                batch::nearest(self, frames, queries, &mut nearest);
                for (found, nearest) in found.iter_mut().zip(nearest) {
                    *found = nearest.index;
                }
            });
    }
}

/// Of a row's trajectory.
fn length(row: &[f32; ROW_STRIDE]) -> f32 {
    let squares = row[POSE_DIM..FEATURE_DIM].iter().map(|value| value * value);
    squares.sum::<f32>().sqrt()
}

impl std::fmt::Debug for Index {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "index of {} bytes", self.bytes())
    }
}
