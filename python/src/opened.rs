//! Tasks with their data. What is loaded already is shared by all who ask for the same.

use anyhow::Result;
use footwork::env::EnvSpec;
use footwork::gpu::Device;
use footwork::rl::rollout::check_fits;
use footwork::train::config::Config;
use footwork::train::memory;
use footwork::train::task::Task;
use footwork::train::tasks::{REGISTRY, find};
use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// A task with its choices made and its data loaded.
pub struct Opened {
    pub task: Box<dyn Task>,
    /// The dimensions of its environments.
    pub spec: EnvSpec,
    /// What the user should know of how the data was loaded.
    pub notes: Vec<String>,
    /// Keeps the data for others.
    _shared: Option<Arc<dyn Task>>,
}

/// Names of all tasks, and what each is about.
pub fn tasks() -> Vec<(&'static str, &'static str)> {
    REGISTRY
        .iter()
        .map(|entry| (entry.name, entry.about))
        .collect()
}

impl Opened {
    /// Checks a configuration and loads its data; what the choices turn out to be goes into it.
    ///
    /// # Errors
    /// A choice or data that cannot be used; more than the machine has memory for.
    pub fn new(config: &mut Config) -> Result<Opened> {
        let entry = find(&config.task.name)?;
        let spec = entry.check(config)?;
        check_fits(&Device::Cpu, &spec, config.ppo.rollout_length)?;
        let needed = memory::of_training(&spec, config);
        memory::check(needed, "use a smaller num_envs or ppo.rollout_length")?;
        let mut opened = match key(config) {
            None => Opened::loaded(config, spec)?,
            Some(key) => Opened::shared(config, spec, key)?,
        };
        config.task.settings = opened.task.settings();
        opened.spec = spec;
        Ok(opened)
    }

    fn loaded(config: &Config, spec: EnvSpec) -> Result<Opened> {
        let loaded = (find(&config.task.name)?.load)(config)?;
        Ok(Opened {
            task: loaded.task,
            spec,
            notes: loaded.notes,
            _shared: None,
        })
    }

    fn shared(config: &Config, spec: EnvSpec, key: String) -> Result<Opened> {
        static LOADED: Mutex<Option<HashMap<String, Weak<dyn Task>>>> = Mutex::new(None);
        let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
        let loaded = loaded.get_or_insert_with(HashMap::new);
        loaded.retain(|_, task| task.strong_count() > 0);
        let found = loaded.get(&key).and_then(Weak::upgrade);
        let (task, notes) = match found {
            Some(task) => (task, Vec::new()),
            None => {
                let Opened { task, notes, .. } = Opened::loaded(config, spec)?;
                let task: Arc<dyn Task> = task.into();
                loaded.insert(key, Arc::downgrade(&task));
                (task, notes)
            }
        };
        Ok(Opened {
            task: task.with_choices(config)?,
            spec,
            notes,
            _shared: Some(task),
        })
    }
}

/// All that decides what is loaded; `None` where that cannot be told from outside.
fn key(config: &Config) -> Option<String> {
    let weights = config.task.settings.get("weights");
    let files = [&config.data, &config.roles, &config.skills];
    let stamps = files.map(|file| file.as_deref().map_or(Some(0), stamp));
    let [data, roles, skills] = stamps;
    let others = (config.ground, config.unit_m, &config.data_folder);
    Some(format!(
        "{} {:?} {} {} {} {others:?} {weights:?}",
        config.task.name, files, data?, roles?, skills?
    ))
}

/// A number that changes with a file, or with the files of a folder.
fn stamp(path: &Path) -> Option<u64> {
    // A motion list names other files.
    if path.extension().is_some_and(|ending| ending == "toml") {
        return None;
    }
    let mut hash = DefaultHasher::new();
    let mut add = |path: &Path| -> Option<()> {
        let about = path.metadata().ok()?;
        (path, about.len(), about.modified().ok()?).hash(&mut hash);
        Some(())
    };
    add(path)?;
    if path.is_dir() {
        for entry in path.read_dir().ok()? {
            let entry = entry.ok()?.path();
            match entry.is_dir() {
                // What is deeper in there may count, too.
                true => return None,
                false => add(&entry)?,
            }
        }
    }
    Some(hash.finish())
}
