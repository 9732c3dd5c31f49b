//! The choices of a configuration, from Python's keyword arguments.

use crate::errors::raised;
use footwork::gpu::Choice;
use footwork::train::config::{Base, Config, Preset};
use footwork::train::task::TaskEntry;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};
use std::path::{Path, PathBuf};

/// What is chosen besides the settings, which are keys of `config.toml`.
pub struct Choices<'a, 'py> {
    pub seed: u32,
    pub data: Option<PathBuf>,
    pub preset: &'a str,
    pub skills: Option<PathBuf>,
    pub settings: Option<&'a Bound<'py, PyDict>>,
}

impl Choices<'_, '_> {
    /// A preset of a task, changed by the settings.
    ///
    /// # Errors
    /// `ValueError` or `TypeError` for what is no choice.
    pub fn config(self, entry: &TaskEntry) -> PyResult<Config> {
        let preset = match self.preset {
            "fast" => Preset::Fast,
            "paper" => Preset::Paper,
            other => {
                let why = format!("preset must be \"fast\" or \"paper\", not {other:?}");
                return Err(PyValueError::new_err(why));
            }
        };
        let mut config = entry.config_of(Base {
            preset,
            steers: self.skills.is_some(),
            envs: None,
        });
        let mut changes = Vec::new();
        if let Some(settings) = self.settings {
            flatten("", settings, &mut changes)?;
        }
        for (key, value) in changes {
            config
                .set(&key, value)
                .map_err(|error| raised(error.into()))?;
        }
        config.device = Choice::Cpu;
        config.seed = self.seed;
        config.data = self.data.or(config.data);
        config.skills = self.skills;
        // A run must find its files again from any folder.
        let paths = [
            &mut config.data,
            &mut config.data_folder,
            &mut config.roles,
            &mut config.skills,
        ];
        for path in paths {
            *path = path.take().map(|path| absolute(&path));
        }
        Ok(config)
    }
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf())
}

/// A seed of everything random.
///
/// # Errors
/// `ValueError` for what does not fit in 32 bits.
pub fn seed(number: &Bound<PyAny>) -> PyResult<u32> {
    number.extract().map_err(|_| {
        let why = format!(
            "seed must be a whole number from 0 to {}, not {number}",
            u32::MAX
        );
        PyValueError::new_err(why)
    })
}

/// Keys with the tables they stand in, like `ppo.gamma`.
fn flatten(
    within: &str,
    table: &Bound<PyDict>,
    changes: &mut Vec<(String, toml::Value)>,
) -> PyResult<()> {
    for (key, value) in table {
        let Ok(name) = key.extract::<String>() else {
            let why = format!("a setting's name must be a string, not {}", key.repr()?);
            return Err(PyTypeError::new_err(why));
        };
        let key = format!("{within}{name}");
        match value.cast::<PyDict>() {
            Ok(table) => flatten(&format!("{key}."), table, changes)?,
            Err(_) => changes.push((key.clone(), toml_value(&key, &value)?)),
        }
    }
    Ok(())
}

fn toml_value(key: &str, value: &Bound<PyAny>) -> PyResult<toml::Value> {
    // A bool is an int in Python, and NumPy's numbers are as good as Python's.
    if let Ok(value) = value.extract::<bool>() {
        return Ok(value.into());
    }
    if let Ok(value) = value.extract::<i64>() {
        return Ok(value.into());
    }
    if let Ok(value) = value.extract::<f64>() {
        return Ok(value.into());
    }
    if let Ok(value) = value.extract::<String>() {
        return Ok(value.into());
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items = value.try_iter()?;
        let items = items.map(|item| toml_value(key, &item?));
        return Ok(toml::Value::Array(items.collect::<PyResult<_>>()?));
    }
    if let Ok(path) = value.extract::<PathBuf>() {
        return Ok(path.to_string_lossy().into_owned().into());
    }
    let found = value.get_type();
    let why = format!(
        "{key} must be a bool, a number, a string, a path, a list or a dict, not {}",
        found.name()?
    );
    Err(PyTypeError::new_err(why))
}
