//! A database together with the search of its candidates.

use super::index::{DEFAULT_TABLE_BYTES, Index};
use super::search::{Nearest, SearchScratch};
use crate::container::StoreError;
use crate::kernels::search::search_exact::squared;
use crate::motion::database::Database;
use crate::motion::features::ROW_STRIDE;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What motion matching needs: the motion, and how its frames are found. Cloning shares both.
#[derive(Clone, Debug)]
pub struct MotionMatcher {
    /// The motion.
    pub database: Arc<Database>,
    /// The index of [`Database::candidates`]. Without one all candidates are compared, with the same result.
    pub index: Option<Arc<Index>>,
}

impl MotionMatcher {
    /// Builds the index of all candidates.
    pub fn new(database: Arc<Database>) -> Self {
        let (frames, candidates) = (&database.features, &database.candidates);
        let index = Index::build(frames, candidates, DEFAULT_TABLE_BYTES);
        MotionMatcher {
            index: Some(Arc::new(index)),
            database,
        }
    }

    /// Nearest candidate of one query, whose pose half is that of `frame`; of equals the lowest.
    pub fn nearest(&self, frame: u32, query: &[f32; ROW_STRIDE]) -> Nearest {
        match &self.index {
            Some(index) => index.nearest(frame, query),
            None => scan(&self.database, query),
        }
    }

    /// [`MotionMatcher::nearest`] in memory that is there already: from the second search on nothing is allocated.
    pub fn nearest_with(
        &self,
        frame: u32,
        query: &[f32; ROW_STRIDE],
        scratch: &mut SearchScratch,
    ) -> Nearest {
        match &self.index {
            Some(index) => index.nearest_with(frame, query, scratch),
            None => scan(&self.database, query),
        }
    }

    /// Nearest candidate of every query, on all cores.
    pub fn nearest_all(&self, frames: &[u32], queries: &[[f32; ROW_STRIDE]], found: &mut [u32]) {
        match &self.index {
            Some(index) => index.nearest_all(frames, queries, found),
            None => {
                for (query, found) in queries.iter().zip(found) {
                    *found = scan(&self.database, query).index;
                }
            }
        }
    }

    /// Reads the index file beside the file at `path` that the database was read from. Where there is
    /// none, or none of this database, the index is built.
    pub fn open(database: Arc<Database>, path: &Path) -> Self {
        let (frames, candidates) = (&database.features, &database.candidates);
        match Index::load(&index_path(path), database.fingerprint, frames, candidates) {
            Some(index) => MotionMatcher {
                index: Some(Arc::new(index)),
                database,
            },
            None => Self::new(database),
        }
    }

    /// Writes the index file beside the database file at `path`, to be found by [`MotionMatcher::open`].
    /// Without an index there is nothing to write.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn save_index(&self, path: &Path) -> Result<(), StoreError> {
        let fingerprint = self.database.fingerprint;
        let index = self.index.as_ref();
        index.map_or(Ok(()), |index| index.save(&index_path(path), fingerprint))
    }
}

/// Compares all candidates.
fn scan(database: &Database, query: &[f32; ROW_STRIDE]) -> Nearest {
    let mut nearest = Nearest {
        index: 0,
        distance: f32::INFINITY,
    };
    for (index, &frame) in database.candidates.iter().enumerate() {
        let distance = squared(&database.features[frame as usize], query);
        if distance < nearest.distance {
            nearest = Nearest {
                index: index as u32,
                distance,
            };
        }
    }
    nearest
}

/// `walk.footwork.index` for `walk.footwork`.
fn index_path(database: &Path) -> PathBuf {
    let mut name = database.as_os_str().to_os_string();
    name.push(".index");
    PathBuf::from(name)
}
