//! Numbers of one environment in arrays of the form `[field][envs]`.

/// Fields `from` and on of an environment.
pub fn gather<T: Copy>(all: &[T], envs: usize, env: usize, from: usize, values: &mut [T]) {
    for (field, value) in values.iter_mut().enumerate() {
        *value = all[(from + field) * envs + env];
    }
}

/// The opposite of [`gather`].
pub fn scatter<T: Copy>(all: &mut [T], envs: usize, env: usize, from: usize, values: &[T]) {
    for (field, value) in values.iter().enumerate() {
        all[(from + field) * envs + env] = *value;
    }
}
