//! Footwork for Python: the compiled half of the package `footwork`.
//!
//! - `vector`, `batch`: environments stepped together, and their face in Python;
//! - `database`: motion, import and search;
//! - `policy`, `training`: what a run has learned, and how one is started;
//! - `opened`, `settings`: tasks by name, with the choices that keyword arguments name;
//! - `arrays`, `errors`, `pool`: NumPy, exceptions, threads.

mod arrays;
mod batch;
mod database;
mod errors;
mod opened;
mod policy;
mod pool;
mod settings;
mod training;
mod vector;

use pyo3::prelude::*;

#[pymodule]
fn _footwork(module: &Bound<PyModule>) -> PyResult<()> {
    module.add("Error", module.py().get_type::<errors::Error>())?;
    module.add("TASKS", opened::tasks())?;
    module.add("OBSERVATION_LIMIT", vector::OBSERVATION_LIMIT)?;
    module.add_class::<batch::Batch>()?;
    module.add_class::<database::Database>()?;
    module.add_class::<policy::Policy>()?;
    module.add_function(wrap_pyfunction!(database::import_bvh, module)?)?;
    module.add_function(wrap_pyfunction!(training::train, module)?)
}
