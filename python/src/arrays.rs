//! NumPy's arrays: checked on their way in, handed over without copies on their way out.

use numpy::{
    Element, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods, dtype,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// A shape that is expected: `None` is any length.
type Shape<const N: usize> = [Option<usize>; N];

/// A copy of `[rows][columns]` finite numbers in single precision.
///
/// # Errors
/// `TypeError` and `ValueError` that name what `name` should be and what it is.
pub fn rows(name: &str, value: &Bound<PyAny>, shape: Shape<2>) -> PyResult<Vec<f32>> {
    let array = checked::<f32, 2>(name, value, shape)?;
    let array = array.cast::<PyArray2<f32>>()?.try_readonly();
    let array = array.map_err(|error| PyValueError::new_err(format!("{name}: {error}")))?;
    let numbers = match array.as_slice() {
        Ok(numbers) => numbers.to_vec(),
        Err(_) => array.as_array().iter().copied().collect(),
    };
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(numbers),
        Some(at) => {
            let columns = array.shape()[1];
            Err(PyValueError::new_err(format!(
                "{name}[{}, {}] is {}, which is no finite number",
                at / columns,
                at % columns,
                numbers[at]
            )))
        }
    }
}

/// A copy of a column of another type.
///
/// # Errors
/// See [`rows`].
pub fn column<T: Element + Copy>(
    name: &str,
    value: &Bound<PyAny>,
    length: Option<usize>,
) -> PyResult<Vec<T>> {
    let array = checked::<T, 1>(name, value, [length])?;
    let array = array.cast::<PyArray1<T>>()?.try_readonly();
    let array = array.map_err(|error| PyValueError::new_err(format!("{name}: {error}")))?;
    Ok(array.as_array().iter().copied().collect())
}

fn checked<'a, 'py, T: Element, const N: usize>(
    name: &str,
    value: &'a Bound<'py, PyAny>,
    shape: Shape<N>,
) -> PyResult<&'a Bound<'py, PyUntypedArray>> {
    let expected = || {
        let lengths =
            shape.map(|length| length.map_or("n".to_string(), |length| length.to_string()));
        let comma = if N == 1 { "," } else { "" };
        format!(
            "{name} must be a NumPy array of {} and of the shape ({}{comma})",
            dtype::<T>(value.py()),
            lengths.join(", ")
        )
    };
    let Ok(array) = value.cast::<PyUntypedArray>() else {
        let found = value.get_type();
        return Err(PyTypeError::new_err(format!(
            "{}, not {}",
            expected(),
            found.name()?
        )));
    };
    if !array.dtype().is_equiv_to(&dtype::<T>(value.py())) {
        return Err(PyTypeError::new_err(format!(
            "{}, not of {}",
            expected(),
            array.dtype()
        )));
    }
    let found = array.shape();
    let fits = found.len() == N
        && found
            .iter()
            .zip(shape)
            .all(|(found, wanted)| wanted.is_none_or(|wanted| *found == wanted));
    match fits {
        true => Ok(array),
        false => {
            let found = value.getattr("shape")?;
            Err(PyValueError::new_err(format!(
                "{}, not {found}",
                expected()
            )))
        }
    }
}

/// An array of so many columns that takes over the memory of `numbers`.
pub fn table<T: Element>(
    py: Python<'_>,
    numbers: Vec<T>,
    columns: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let rows = numbers.len() / columns.max(1);
    PyArray1::from_vec(py, numbers).reshape([rows, columns])
}
