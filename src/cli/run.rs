//! A trained run, opened.

use anyhow::{Context, Result};
use footwork::motion::database::Database;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::config::Config;
use footwork::train::data;
use footwork::train::run_dir::Folder;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The run's folder, and the checkpoint: the given one, or the last of a given folder.
pub fn locate(run: &Path) -> Result<(Folder, PathBuf)> {
    if run.is_file() {
        let whole = std::path::absolute(run)?;
        let folder = whole.ancestors().nth(2).map(Folder::open);
        let folder = folder.and_then(Result::ok).with_context(|| {
            format!(
                "{} does not lie in the checkpoints of a run: give a run's folder, or one of its checkpoints where it was written",
                run.display()
            )
        })?;
        return Ok((folder, run.to_path_buf()));
    }
    let folder = Folder::open(run)?;
    let last = folder.last()?;
    Ok((folder, last))
}

/// The motion a run was trained with, from where it was or from `moved`.
///
/// # Errors
/// It is in neither place; says where it was and what to pass.
pub fn motion(config: &Config, moved: Option<&Path>) -> Result<Arc<Database>> {
    let path = moved.or(config.data.as_deref());
    if let (None, Some(gone)) = (moved, path.filter(|path| !path.exists())) {
        anyhow::bail!(
            "the motion that the run was trained with is gone: it was {}; say where it is now with --data",
            gone.display()
        );
    }
    let (database, _) = data::load(path, config.weights)?;
    Ok(Arc::new(database))
}

/// A run with one of its checkpoints.
pub struct Run {
    pub checkpoint: Checkpoint,
    pub database: Arc<Database>,
}

impl Run {
    pub fn open(run: &Path, moved: Option<&Path>) -> Result<Run> {
        let (folder, path) = locate(run)?;
        let config = folder.read_config()?;
        let database = motion(&config, moved)?;
        let checkpoint = Checkpoint::load_for(&path, &config.task, database.fingerprint)?;
        Ok(Run {
            checkpoint,
            database,
        })
    }
}
