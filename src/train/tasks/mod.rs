//! The tasks, a file each, and the one list of them.

pub mod boxing;
pub mod imitate;
mod motion_training;
mod motions;
pub mod obstacles;
pub mod plane;
mod presets;
pub mod punch;
pub mod skills;
pub mod stand;
pub mod track;

use super::config::{Base, Config, ConfigError, nearest};
use super::run_dir::RunDir;
use super::task::TaskEntry;

/// Every task there is.
pub static REGISTRY: [TaskEntry; 9] = [
    plane::ENTRY,
    obstacles::ENTRY,
    stand::ENTRY,
    imitate::ENTRY,
    track::ENTRY,
    punch::PUNCH,
    punch::JOYSTICK,
    skills::ENTRY,
    boxing::ENTRY,
];

/// A task by name.
///
/// # Errors
/// There is none; the message has the nearest name.
pub fn find(name: &str) -> Result<&'static TaskEntry, ConfigError> {
    let found = REGISTRY.iter().find(|entry| entry.name == name);
    found.ok_or_else(|| ConfigError::Task {
        name: name.to_string(),
        hint: nearest(name, REGISTRY.iter().map(|entry| entry.name)),
    })
}

/// The configuration of a run.
///
/// # Errors
/// See [`ConfigError`].
pub fn config_of(run: &RunDir) -> Result<Config, ConfigError> {
    let path = run.config_path();
    find(&Config::task_of(&path)?)?.config_from(&path, Base::default())
}
