//! Errors as exceptions.

use footwork::train::config::ConfigError;
use pyo3::PyErr;
use pyo3::exceptions::{PyRuntimeError, PyValueError};

pyo3::create_exception!(
    footwork,
    Error,
    PyRuntimeError,
    "A file, a run or a device that cannot be used; the message says why and what to do."
);

/// `ValueError` for a choice that cannot be, [`Error`] for all else.
pub fn raised(error: anyhow::Error) -> PyErr {
    match error.downcast_ref::<ConfigError>() {
        Some(ConfigError::Set { key, problem }) => {
            PyValueError::new_err(format!("{key}: {problem}"))
        }
        Some(wrong) => PyValueError::new_err(wrong.to_string()),
        None => Error::new_err(format!("{error:#}")),
    }
}
