//! Arrays in host memory or on a GPU, behind one type.

use super::Buffer;
use super::device::Device;
use bytemuck::Pod;
use std::ops::Range;

/// A fixed-length array where a [`Device`] computes: host memory for the CPU, a storage buffer for a
/// GPU. Code that runs on one device takes the form it needs by [`Array::host`] or [`Array::buffer`];
/// asking for the other form is a mistake in the program and panics.
#[derive(Clone)]
pub enum Array<T = f32> {
    /// Host memory, for the CPU.
    Host(Vec<T>),
    /// A storage buffer of a GPU.
    Gpu(Buffer<T>),
}

impl<T: Pod> Array<T> {
    /// `len` zeros on `device`.
    pub fn zeroed(device: &Device, len: usize) -> Self {
        match device {
            Device::Cpu => Array::Host(vec![T::zeroed(); len]),
            Device::Gpu(gpu) => Array::Gpu(Buffer::zeroed(gpu, len)),
        }
    }

    /// A copy of `values` on `device`.
    pub fn from_slice(device: &Device, values: &[T]) -> Self {
        match device {
            Device::Cpu => Array::Host(values.to_vec()),
            Device::Gpu(gpu) => Array::Gpu(Buffer::from_slice(gpu, values)),
        }
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        match self {
            Array::Host(values) => values.len(),
            Array::Gpu(buffer) => buffer.len(),
        }
    }

    /// Whether there are no elements.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The elements in host memory.
    ///
    /// # Panics
    /// If the array is on a GPU.
    pub fn host(&self) -> &[T] {
        match self {
            Array::Host(values) => values,
            Array::Gpu(_) => unreachable!("an array of the CPU was expected"),
        }
    }

    /// The elements in host memory, to be written.
    ///
    /// # Panics
    /// If the array is on a GPU.
    pub fn host_mut(&mut self) -> &mut [T] {
        match self {
            Array::Host(values) => values,
            Array::Gpu(_) => unreachable!("an array of the CPU was expected"),
        }
    }

    /// The storage buffer.
    ///
    /// # Panics
    /// If the array is in host memory.
    pub fn buffer(&self) -> &Buffer<T> {
        match self {
            Array::Host(_) => unreachable!("an array of a GPU was expected"),
            Array::Gpu(buffer) => buffer,
        }
    }

    /// Copies the elements to the host.
    ///
    /// # Errors
    /// The device was lost.
    pub fn read(&self, device: &Device) -> anyhow::Result<Vec<T>> {
        match (self, device) {
            (Array::Host(values), _) => Ok(values.clone()),
            (Array::Gpu(buffer), Device::Gpu(gpu)) => buffer.read(gpu),
            (Array::Gpu(_), Device::Cpu) => unreachable!("an array of the CPU was expected"),
        }
    }
}

impl Array {
    /// A copy of a range of elements, on the same device.
    pub fn copy(&self, device: &Device, range: Range<usize>) -> Self {
        match (self, device) {
            (Array::Host(values), _) => Array::Host(values[range].to_vec()),
            (Array::Gpu(buffer), Device::Gpu(gpu)) => Array::Gpu(buffer.copy(gpu, range)),
            (Array::Gpu(_), Device::Cpu) => unreachable!("an array of the CPU was expected"),
        }
    }
}

impl<T> From<Vec<T>> for Array<T> {
    fn from(values: Vec<T>) -> Self {
        Array::Host(values)
    }
}
