//! Where a run's database comes from.

use crate::motion::database::Database;
use crate::motion::import::{ImportOptions, import};
use crate::motion::normalise::Weights;
use crate::motion::synthetic;
use crate::container::StoreError;
use anyhow::{Result, bail};
use std::path::Path;

/// Seed of the embedded synthetic data: the same for every run.
pub const SYNTHETIC_SEED: u64 = 1;

/// A database file, a BVH file or a folder of them; without a path the synthetic performer's
/// motion. The notes say what the user should know of an import.
pub fn load(path: Option<&Path>, weights: Weights) -> Result<(Database, Vec<String>)> {
    let Some(path) = path else {
        let (clips, roles) = synthetic::perform(SYNTHETIC_SEED, synthetic::MINUTES);
        let note = "no data given: synthetic motion of the built-in performer".to_string();
        return Ok((Database::build(&clips, roles, weights)?, vec![note]));
    };
    let bvh = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("bvh"));
    if path.is_dir() || bvh {
        return from_bvh(path, &ImportOptions::default(), weights);
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

/// Imports BVH files.
pub fn from_bvh(
    path: &Path,
    options: &ImportOptions,
    weights: Weights,
) -> Result<(Database, Vec<String>)> {
    let import = import(path, options)?;
    Ok((
        Database::build(&import.clips, import.roles, weights)?,
        import.notes,
    ))
}
