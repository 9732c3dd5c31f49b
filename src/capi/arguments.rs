//! Pointers that callers pass, as Rust's references.

use super::status::{Failure, FootworkStatus, failure};
use std::ffi::{CStr, c_char};
use std::path::Path;

/// A place for a result.
///
/// # Safety
/// If it is not null, it points to a `T` that nobody else uses meanwhile.
pub unsafe fn out<'a, T>(pointer: *mut T, name: &str) -> Result<&'a mut T, Failure> {
    // SAFETY: the caller's promise.
    let place = unsafe { pointer.as_mut() };
    place.ok_or_else(|| null(name))
}

/// A path.
///
/// # Safety
/// If it is not null, it points to a text that ends with a zero.
pub unsafe fn path<'a>(pointer: *const c_char, name: &str) -> Result<&'a Path, Failure> {
    if pointer.is_null() {
        return Err(null(name));
    }
    // SAFETY: the caller's promise.
    let text = unsafe { CStr::from_ptr(pointer) }.to_str();
    let text = text.map_err(|_| {
        let text = format!("`{name}` is not UTF-8");
        failure(FootworkStatus::InvalidValue, text)
    });
    text.map(Path::new)
}

/// An array to be read. Where it is empty the pointer does not matter.
///
/// # Safety
/// If it is not null, it points to `len` values.
pub unsafe fn array<'a, T>(pointer: *const T, len: usize, name: &str) -> Result<&'a [T], Failure> {
    if len == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() {
        return Err(null(name));
    }
    if len > isize::MAX as usize / size_of::<T>() {
        return Err(wrong_size(name, len, "what memory can hold"));
    }
    // SAFETY: the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(pointer, len) })
}

/// An array of exactly so many values to be written.
///
/// # Safety
/// If it is not null, it points to `len` values that nobody else uses meanwhile.
pub unsafe fn array_out<'a, T>(
    pointer: *mut T,
    len: usize,
    wanted: usize,
    name: &str,
) -> Result<&'a mut [T], Failure> {
    if pointer.is_null() {
        return Err(null(name));
    }
    if len != wanted {
        return Err(wrong_size(name, len, &wanted.to_string()));
    }
    // SAFETY: the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, len) })
}

/// A point or a direction on the ground.
pub fn ground(x: f32, z: f32, name: &str) -> Result<[f32; 2], Failure> {
    finite(&[x, z], name).map(|()| [x, z])
}

/// Refuses what is no number.
pub fn finite(values: &[f32], name: &str) -> Result<(), Failure> {
    match values.iter().all(|value| value.is_finite()) {
        true => Ok(()),
        false => {
            let text = format!("`{name}` has numbers that are not finite");
            Err(failure(FootworkStatus::InvalidValue, text))
        }
    }
}

/// One of `count`, by number.
pub fn index(at: u32, count: usize, what: &str) -> Result<usize, Failure> {
    let index = at as usize;
    match index < count {
        true => Ok(index),
        false => {
            let text = format!("there is no {what} {at}: there are {count}, from 0 on");
            Err(failure(FootworkStatus::OutOfRange, text))
        }
    }
}

fn null(name: &str) -> Failure {
    failure(FootworkStatus::NullPointer, format!("`{name}` is null"))
}

pub fn wrong_size(name: &str, found: usize, wanted: &str) -> Failure {
    let text = format!("`{name}` has a size of {found}, not {wanted}");
    failure(FootworkStatus::WrongSize, text)
}
