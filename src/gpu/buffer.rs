//! Arrays on the device.

use super::adapter::Gpu;
use bytemuck::Pod;
use cubecl::server::Handle;
use cubecl::wgpu::{AutoCompiler, WgpuServer};
use std::marker::PhantomData;
use std::num::NonZeroU64;

/// An array of `len` values of four bytes each on the device. Cloning shares the memory.
#[derive(Clone)]
pub struct Buffer<T> {
    pub(super) handle: Handle,
    len: usize,
    kind: PhantomData<T>,
}

type Server = WgpuServer<AutoCompiler>;

/// An array on the device outside of burn's runtime, whose memory stays where it is while this lives.
pub struct Shared {
    buffer: wgpu::Buffer,
    offset: u64,
    size: u64,
    _memory: Handle,
}

impl Shared {
    /// The binding for a bind group.
    pub fn binding(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.buffer,
            offset: self.offset,
            size: NonZeroU64::new(self.size),
        })
    }
}

/// Any buffer, as a kernel's argument.
pub trait Argument {
    /// The memory, for the runtime.
    fn handle(&self) -> Handle;
}

impl<T: Pod> Argument for Buffer<T> {
    fn handle(&self) -> Handle {
        self.handle.clone()
    }
}

impl<T: Pod> Buffer<T> {
    /// Copies `values` to the device.
    pub fn from_slice(gpu: &Gpu, values: &[T]) -> Self {
        let handle = gpu.client.create_from_slice(bytemuck::cast_slice(values));
        Self::wrap(handle, values.len())
    }

    /// `len` values, all zero.
    pub fn zeroed(gpu: &Gpu, len: usize) -> Self {
        Self::from_slice(gpu, &vec![T::zeroed(); len])
    }

    /// `len` values of no meaning, for a kernel to write: memory comes from the device's pool.
    pub fn empty(gpu: &Gpu, len: usize) -> Self {
        Self::wrap(gpu.client.empty(len * size_of::<T>()), len)
    }

    pub(super) fn wrap(handle: Handle, len: usize) -> Self {
        Self {
            handle,
            len,
            kind: PhantomData,
        }
    }

    /// The buffer itself, for whoever draws on the same device.
    ///
    /// # Errors
    /// The device was lost.
    pub fn share(&self, gpu: &Gpu) -> anyhow::Result<Shared> {
        let resource = gpu.client.get_resource::<Server>(self.handle.clone());
        let resource = resource.map_err(|error| anyhow::anyhow!("the GPU stopped: {error:?}"))?;
        let resource = resource.resource();
        Ok(Shared {
            buffer: resource.buffer.clone(),
            offset: resource.offset,
            size: resource.size,
            _memory: self.handle.clone(),
        })
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no elements.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Waits for the device and copies everything to the host.
    ///
    /// # Errors
    /// The device was lost or a kernel that writes this buffer failed.
    pub fn read(&self, gpu: &Gpu) -> anyhow::Result<Vec<T>> {
        let bytes = gpu
            .client
            .read_one(self.handle.clone())
            .map_err(|error| anyhow::anyhow!("reading from the GPU failed: {error:?}"))?;
        Ok(bytemuck::pod_collect_to_vec::<u8, T>(&bytes)[..self.len].to_vec())
    }
}
