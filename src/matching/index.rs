//! The index: the candidates' rows sorted for pruning, what is known of their poses, and its file.

use super::pca::PrincipalAxes;
use super::pose_distance_table::{PoseDistanceTable, TableLayout};
use super::tree::KdTree;
use crate::container::{Arrays, Format, StoreError};
use crate::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Bytes that the table of pose distances takes unless requested otherwise: WebGPU's default limit of
/// a binding.
pub const DEFAULT_TABLE_BYTES: usize = 128 << 20;

/// The rows, sorted for pruning, and what is known of their poses.
pub struct Index {
    pub(super) axes: PrincipalAxes,
    pub(super) tree: KdTree,
    pub(super) poses: PoseDistanceTable,
    /// Norm of the longest trajectory.
    pub(super) max_norm: f32,
}

const FORMAT: Format = Format {
    kind: "index",
    version: 3,
};

#[derive(Serialize, Deserialize)]
struct Header {
    /// Fingerprint of the database.
    fingerprint: u32,
    shape: TableLayout,
}

impl Index {
    /// Builds the index of the rows `candidates` of `frames`, of which there must be at least one.
    /// The table of pose distances takes at most `table_bytes`, or as little as it can.
    pub fn build(frames: &[[f32; ROW_STRIDE]], candidates: &[u32], table_bytes: usize) -> Self {
        let rows: Vec<_> = candidates.iter().map(|&at| frames[at as usize]).collect();
        let axes = PrincipalAxes::of(&rows);
        let tree = KdTree::build(&rows, &axes, None);
        let poses = PoseDistanceTable::build(frames, &tree, table_bytes);
        Self::join(&rows, axes, tree, poses)
    }

    fn join(
        rows: &[[f32; ROW_STRIDE]],
        axes: PrincipalAxes,
        tree: KdTree,
        poses: PoseDistanceTable,
    ) -> Self {
        Index {
            max_norm: rows.iter().map(trajectory_norm).fold(0.0, f32::max),
            axes,
            tree,
            poses,
        }
    }

    /// Writes what is slow to find: the order of the rows and the table of pose distances.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn save(&self, path: &Path, fingerprint: u32) -> Result<(), StoreError> {
        let mut arrays = Arrays::default();
        arrays.put("order", &self.tree.order());
        arrays.put("by_leaf", &self.poses.by_leaf);
        arrays.put("by_group", &pad_to_words(&self.poses.by_group));
        let header = Header {
            fingerprint,
            shape: self.poses.layout,
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
        let complete = sorted.iter().copied().eq(0..candidates.len() as u32);
        if header.fingerprint != fingerprint || !complete {
            return None;
        }
        let rows: Vec<_> = candidates.iter().map(|&at| frames[at as usize]).collect();
        let axes = PrincipalAxes::of(&rows);
        let tree = KdTree::build(&rows, &axes, Some(order));
        let poses = PoseDistanceTable::restore(
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
}

/// Bytes filled up with zeros to whole words, as files and devices hold them.
pub(super) fn pad_to_words(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes
}

/// Norm of a row's trajectory.
pub(super) fn trajectory_norm(row: &[f32; ROW_STRIDE]) -> f32 {
    let squares = row[POSE_DIM..FEATURE_DIM].iter().map(|value| value * value);
    squares.sum::<f32>().sqrt()
}

impl std::fmt::Debug for Index {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "index of {} bytes", self.bytes())
    }
}
