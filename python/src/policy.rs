//! What a run has learned, to be called.

use crate::arrays::{rows, table};
use crate::batch::{Batch, autoreset};
use crate::errors::{Error, raised};
use crate::pool;
use crate::settings;
use crate::vector::{Vector, action_scale};
use footwork::gpu::Choice;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::config::Config;
use footwork::train::run_dir::checkpoint_of;
use numpy::PyArray2;
use pyo3::prelude::*;
use std::path::PathBuf;

/// A trained policy.
#[pyclass(frozen, module = "footwork._footwork")]
pub struct Policy {
    policy: footwork::nn::Policy,
    header: footwork::train::checkpoint::Header,
    config: Config,
}

#[pymethods]
impl Policy {
    /// Reads a run's last checkpoint, or a given one.
    #[staticmethod]
    fn load(py: Python<'_>, run: PathBuf) -> PyResult<Policy> {
        let checkpoint = py.detach(|| anyhow::Ok(Checkpoint::load(&checkpoint_of(&run)?)?));
        let Checkpoint { header, policy, .. } = checkpoint.map_err(raised)?;
        let config = toml::from_str(&header.config).map_err(|error| {
            Error::new_err(format!(
                "{}: its configuration: {}",
                run.display(),
                error.message()
            ))
        })?;
        Ok(Policy {
            policy,
            header,
            config,
        })
    }

    #[getter]
    fn task(&self) -> &str {
        &self.header.task
    }

    /// Environment steps of its training.
    #[getter]
    fn steps(&self) -> u64 {
        self.header.steps
    }

    /// The text of the run's `config.toml`.
    #[getter]
    fn config(&self) -> &str {
        &self.header.config
    }

    #[getter]
    fn observation_dim(&self) -> usize {
        self.policy.observation().dim()
    }

    #[getter]
    fn action_dim(&self) -> usize {
        self.policy.action()
    }

    /// Length of a step, s.
    #[getter]
    fn dt(&self) -> f32 {
        self.header.spec.dt
    }

    /// Mean actions `[n][action]` for observations `[n][observation]`.
    fn act<'py>(
        &self,
        py: Python<'py>,
        observations: &Bound<PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let seen = rows(
            "observations",
            observations,
            [None, Some(self.observation_dim())],
        )?;
        let scale = 1.0 / action_scale(&self.header.spec);
        let actions = py.detach(|| {
            let mut actions = pool::install(|| self.policy.mean(&seen));
            actions.iter_mut().for_each(|number| *number *= scale);
            actions
        });
        table(py, actions, self.action_dim())
    }

    /// Environments as the policy was trained in.
    #[pyo3(signature = (num_envs, seed, autoreset_mode, data=None))]
    fn batch(
        &self,
        py: Python<'_>,
        num_envs: i64,
        seed: &Bound<PyAny>,
        autoreset_mode: &str,
        data: Option<PathBuf>,
    ) -> PyResult<Batch> {
        let autoreset = autoreset(autoreset_mode)?;
        let config = Config {
            device: Choice::Cpu,
            seed: settings::seed(seed)?,
            data: data.or(self.config.data.clone()),
            ..self.config.clone()
        };
        let vector = py.detach(|| Vector::new(config, num_envs, autoreset));
        Ok(Batch::of(vector.map_err(raised)?))
    }
}
