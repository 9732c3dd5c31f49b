//! Environments as Python's classes see them: NumPy in and out.

use crate::arrays::{column, rows, table};
use crate::errors::raised;
use crate::settings::{self, Choices};
use crate::vector::{Autoreset, Step, Vector, action_scale};
use footwork::train::tasks::find;
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A batch of environments, stepped on all cores without Python's lock.
#[pyclass(frozen, module = "footwork._footwork")]
pub struct Batch(Mutex<Vector>);

impl Batch {
    pub fn of(vector: Vector) -> Batch {
        Batch(Mutex::new(vector))
    }

    fn vector(&self) -> MutexGuard<'_, Vector> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The mode of the name that Gymnasium gives it.
pub fn autoreset(name: &str) -> PyResult<Autoreset> {
    match name {
        "SameStep" => Ok(Autoreset::SameStep),
        "NextStep" => Ok(Autoreset::NextStep),
        "Disabled" => Ok(Autoreset::Disabled),
        other => Err(PyValueError::new_err(format!(
            "autoreset_mode must be SameStep, NextStep or Disabled, not {other}"
        ))),
    }
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (task, num_envs, seed, autoreset_mode, data=None, preset="fast", skills=None, settings=None))]
    fn new(
        py: Python<'_>,
        task: &str,
        num_envs: i64,
        seed: &Bound<PyAny>,
        autoreset_mode: &str,
        data: Option<PathBuf>,
        preset: &str,
        skills: Option<PathBuf>,
        settings: Option<&Bound<PyDict>>,
    ) -> PyResult<Batch> {
        let entry = find(task).map_err(|error| raised(error.into()))?;
        let choices = Choices {
            seed: settings::seed(seed)?,
            data,
            preset,
            skills,
            settings,
        };
        let (config, autoreset) = (choices.config(entry)?, autoreset(autoreset_mode)?);
        let vector = py.detach(|| Vector::new(config, num_envs, autoreset));
        Ok(Batch::of(vector.map_err(raised)?))
    }

    /// Rows of a batch: agents of all environments.
    #[getter]
    fn num_envs(&self) -> usize {
        self.vector().spec.rows()
    }

    #[getter]
    fn agents(&self) -> usize {
        self.vector().spec.agents
    }

    /// Numbers of an observation that are no map's; they come first.
    #[getter]
    fn vector_dim(&self) -> usize {
        self.vector().spec.observation.vector
    }

    /// `(height, width, channels)` of the maps behind them.
    #[getter]
    fn map_shape(&self) -> Option<(usize, usize, usize)> {
        self.vector()
            .spec
            .observation
            .grid
            .map(|[height, width, channels]| (height, width, channels))
    }

    /// Numbers of an observation, from its first on, that say how a body moves.
    #[getter]
    fn style_dim(&self) -> usize {
        self.vector().spec.style
    }

    #[getter]
    fn action_dim(&self) -> usize {
        self.vector().spec.action
    }

    #[getter]
    fn action_scale(&self) -> f32 {
        action_scale(&self.vector().spec)
    }

    /// Length of a step, s.
    #[getter]
    fn dt(&self) -> f32 {
        self.vector().spec.dt
    }

    #[getter]
    fn level(&self) -> Option<u32> {
        self.vector().level()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.vector().notes().to_vec()
    }

    /// Names of an episode's statistics; the first counts episodes.
    #[getter]
    fn stat_names(&self) -> Vec<&'static str> {
        self.vector().stat_names.to_vec()
    }

    #[pyo3(signature = (seed=None, mask=None))]
    fn reset<'py>(
        &self,
        py: Python<'py>,
        seed: Option<&Bound<PyAny>>,
        mask: Option<&Bound<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let seed = seed.map(settings::seed).transpose()?;
        let (rows, width) = {
            let spec = &self.vector().spec;
            (spec.rows(), spec.observation.dim())
        };
        let mask = mask
            .map(|mask| column::<bool>("reset_mask", mask, Some(rows)))
            .transpose()?;
        let observation = py.detach(|| match (&mask, seed) {
            (Some(_), Some(_)) => {
                anyhow::bail!("a seed is for all environments: leave out reset_mask")
            }
            (Some(mask), None) => self.vector().reset_rows(mask),
            (None, seed) => self.vector().reset(seed),
        });
        Ok(table(py, observation.map_err(raised)?, width)?.into_any())
    }

    /// Observations, rewards, terminations, truncations; then the rows that ended, their last observations, and the
    /// statistics of their episodes.
    fn step<'py>(&self, py: Python<'py>, actions: &Bound<PyAny>) -> PyResult<Bound<'py, PyTuple>> {
        let (spec, over) = {
            let vector = self.vector();
            (vector.spec, vector.first_over())
        };
        if let Some(row) = over {
            return Err(PyValueError::new_err(format!(
                "the episode of environment {row} has ended: reset it first, with options={{\"reset_mask\": ...}}"
            )));
        }
        let actions = rows("actions", actions, [Some(spec.rows()), Some(spec.action)])?;
        let Step {
            observation,
            reward,
            terminated,
            truncated,
            ended,
            final_observation,
            stats,
        } = py.detach(|| self.vector().step(&actions)).map_err(raised)?;
        let (width, names) = (spec.observation.dim(), self.vector().stat_names.len());
        let flags = |flags: Vec<bool>| PyArray1::from_vec(py, flags);
        let ended: Vec<i64> = ended.into_iter().map(|row| row as i64).collect();
        (
            table(py, observation, width)?,
            PyArray1::from_vec(py, reward),
            flags(terminated),
            flags(truncated),
            PyArray1::from_vec(py, ended),
            table(py, final_observation, width)?,
            table(py, stats, names)?,
        )
            .into_pyobject(py)
    }

    /// How many episodes ended since the last call, and means over them.
    fn take_means(&self) -> Vec<(&'static str, f64)> {
        self.vector().take_means()
    }
}
