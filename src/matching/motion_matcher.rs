//! A database together with the index of its candidates.

use super::index::{DEFAULT_TABLE_BYTES, Index};
use crate::container::StoreError;
use crate::motion::database::Database;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What motion matching needs: the motion, and the index by which its frames are found. Cloning shares
/// both.
#[derive(Clone, Debug)]
pub struct MotionMatcher {
    /// The motion.
    pub database: Arc<Database>,
    /// The index of [`Database::candidates`].
    pub index: Arc<Index>,
}

impl MotionMatcher {
    /// Builds the index of all candidates.
    pub fn new(database: Arc<Database>) -> Self {
        let (frames, candidates) = (&database.features, &database.candidates);
        let index = Arc::new(Index::build(frames, candidates, DEFAULT_TABLE_BYTES));
        MotionMatcher { database, index }
    }

    /// Reads the index file beside the file at `path` that the database was read from. Where there is
    /// none, or none of this database, the index is built.
    pub fn open(database: Arc<Database>, path: &Path) -> Self {
        let (frames, candidates) = (&database.features, &database.candidates);
        match Index::load(&index_path(path), database.fingerprint, frames, candidates) {
            Some(index) => MotionMatcher {
                index: Arc::new(index),
                database,
            },
            None => Self::new(database),
        }
    }

    /// Writes the index file beside the database file at `path`, to be found by [`MotionMatcher::open`].
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn save_index(&self, path: &Path) -> Result<(), StoreError> {
        self.index
            .save(&index_path(path), self.database.fingerprint)
    }
}

/// `walk.footwork.index` for `walk.footwork`.
fn index_path(database: &Path) -> PathBuf {
    let mut name = database.as_os_str().to_os_string();
    name.push(".index");
    PathBuf::from(name)
}
