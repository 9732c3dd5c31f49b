//! The GPU of a build without the feature `gpu`: types that no value has. Code for GPUs compiles
//! against them and is dropped.

use super::no_adapter::{INSTEAD, NoAdapter};
use super::shader::Shader;
use bytemuck::Pod;
use std::convert::Infallible;
use std::marker::PhantomData;

const NONE: NoAdapter = NoAdapter {
    wanted: "GPU",
    remedy: "this program was built without the feature `gpu`",
    instead: INSTEAD,
};

/// A GPU that is not there.
#[derive(Clone)]
pub struct Gpu {
    never: Infallible,
    /// The adapter's own name.
    pub name: String,
    pub(super) max_binding: u64,
    /// Whether it is a software rasteriser.
    pub software: bool,
}

/// An array on a GPU that is not there.
#[derive(Clone)]
pub struct Buffer<T> {
    never: Infallible,
    kind: PhantomData<T>,
}

/// An array of a GPU that is not there, outside of its runtime.
pub struct Shared {
    _never: Infallible,
}

/// Any buffer, as a kernel's argument.
pub trait Argument {}

impl<T: Pod> Argument for Buffer<T> {}

impl Gpu {
    /// # Errors
    /// Always.
    pub fn real() -> Result<Self, NoAdapter> {
        Err(NONE)
    }

    /// # Errors
    /// Always.
    pub fn lavapipe() -> Result<Self, NoAdapter> {
        Err(NONE)
    }

    pub(super) fn sync(&self) -> anyhow::Result<()> {
        match self.never {}
    }

    /// Never called.
    pub fn launch<P: Pod>(&self, _: &'static Shader, _: [u32; 3], _: &[&dyn Argument], _: &P) {
        match self.never {}
    }
}

impl<T: Pod> Buffer<T> {
    /// Never called.
    pub fn from_slice(gpu: &Gpu, _: &[T]) -> Self {
        match gpu.never {}
    }

    /// Never called.
    pub fn zeroed(gpu: &Gpu, _: usize) -> Self {
        match gpu.never {}
    }

    /// Never called.
    pub fn empty(gpu: &Gpu, _: usize) -> Self {
        match gpu.never {}
    }

    /// Never called.
    pub fn share(&self, _: &Gpu) -> anyhow::Result<Shared> {
        match self.never {}
    }

    /// Never called.
    pub fn len(&self) -> usize {
        match self.never {}
    }

    /// Never called.
    pub fn is_empty(&self) -> bool {
        match self.never {}
    }

    /// Never called.
    pub fn read(&self, _: &Gpu) -> anyhow::Result<Vec<T>> {
        match self.never {}
    }

    pub(super) fn copy(&self, _: &Gpu, _: std::ops::Range<usize>) -> Self {
        match self.never {}
    }
}
