//! The motion of a run: a database file, recordings, or the synthetic performer's.

use crate::container::StoreError;
use crate::matching::MotionMatcher;
use crate::motion::database::Database;
use crate::motion::import::{ImportOptions, import};
use crate::motion::normalise::Weights;
use crate::motion::synthetic;
use anyhow::{Result, bail};
use std::path::Path;
use std::sync::Arc;

/// Seed of the embedded synthetic data: the same for every run.
pub const SYNTHETIC_SEED: u64 = 1;

/// Loads a database file, a BVH file or a folder of them; without a path the synthetic performer's
/// motion. The notes say what the user should know of an import.
///
/// # Errors
/// The data is missing, damaged or something else, or no clip is long enough to be matched.
pub fn load(path: Option<&Path>, weights: Weights) -> Result<(Database, Vec<String>)> {
    load_with(path, &ImportOptions::default(), weights)
}

/// Loads as [`load`] does, with choices for BVH files.
///
/// # Errors
/// Those of [`load`].
pub fn load_with(
    path: Option<&Path>,
    options: &ImportOptions,
    weights: Weights,
) -> Result<(Database, Vec<String>)> {
    let Some(path) = path else {
        let (clips, roles) = synthetic::perform(SYNTHETIC_SEED, synthetic::MINUTES);
        let note = "no data given: synthetic motion of the built-in performer".to_string();
        return Ok((Database::build(&clips, roles, weights)?, vec![note]));
    };
    let bvh = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("bvh"));
    if path.is_dir() || bvh {
        return from_bvh(path, options, weights);
    }
    match Database::load(path) {
        Ok(database) => Ok((database, Vec::new())),
        Err(StoreError::Foreign { .. }) => bail!(
            "{} is neither a folder, nor a .bvh file, nor a footwork database",
            path.display()
        ),
        Err(error) => Err(error.into()),
    }
}

/// Loads a database as [`load`] does, and with it the index of its candidates: the file beside a
/// database file, or one that is built.
///
/// # Errors
/// Those of [`load`].
pub fn load_matcher(path: Option<&Path>, weights: Weights) -> Result<(MotionMatcher, Vec<String>)> {
    let (database, notes) = load(path, weights)?;
    let database = Arc::new(database);
    let matcher = match path {
        Some(path) => MotionMatcher::open(database, path),
        None => MotionMatcher::new(database),
    };
    Ok((matcher, notes))
}

/// Imports BVH files.
///
/// # Errors
/// They are missing or damaged, or no clip is long enough to be matched.
pub fn from_bvh(
    path: &Path,
    options: &ImportOptions,
    weights: Weights,
) -> Result<(Database, Vec<String>)> {
    let import = import(path, options)?;
    let mut database = Database::build(&import.clips, import.roles, weights)?;
    for (clip, findings) in database.clips.iter_mut().zip(import.findings) {
        clip.findings = findings;
    }
    Ok((database, import.notes))
}
