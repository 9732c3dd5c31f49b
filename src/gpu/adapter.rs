//! A graphics adapter, opened for burn and for this program's kernels alike.

use super::device::Device;
use super::no_adapter::{INSTEAD, NoAdapter};
use burn::backend::Wgpu;
use burn::tensor::wgpu::{MemoryConfiguration, WgpuBackend, WgpuInitError, WgpuSetup};
use burn::tensor::{Device as TensorDevice, DeviceKind, Tensor};
use burn_cubecl::CubeDevice;
use cubecl::client::Client;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

const REMEDY: &str =
    "install a Vulkan, Metal or DX12 driver (Mesa's `mesa-vulkan-drivers` brings lavapipe)";

/// A wgpu device that burn's tensors and this program's kernels share.
#[derive(Clone)]
pub struct Gpu {
    pub(super) client: Client,
    pub(super) cube: CubeDevice,
    pub(super) tensors: TensorDevice,
    /// What burn runs on, for whoever draws on the same device.
    pub setup: WgpuSetup,
    /// The adapter's own name.
    pub name: String,
    /// Bytes a kernel can reach in one buffer.
    pub(super) max_binding: u64,
    /// Lavapipe and its kind: eight lanes, cheap uniform loads, no fast workgroup memory.
    pub software: bool,
}

impl Device {
    /// What to draw on beside it: itself, or what there is to draw on.
    ///
    /// # Errors
    /// There is nothing.
    pub fn drawing(&self) -> Result<Gpu, NoAdapter> {
        match self {
            Device::Gpu(gpu) => Ok((**gpu).clone()),
            Device::Cpu => Gpu::drawing(),
        }
    }
}

impl Gpu {
    /// The first discrete, else integrated, else virtual GPU.
    ///
    /// # Errors
    /// There is none.
    pub fn real() -> Result<Self, NoAdapter> {
        let kinds = [
            DeviceKind::DiscreteGpu(0),
            DeviceKind::IntegratedGpu(0),
            DeviceKind::VirtualGpu(0),
        ];
        let open = |kind| Self::shared(kind, WgpuBackend::Auto).ok();
        let first = kinds.into_iter().find_map(open);
        first.ok_or(NoAdapter {
            wanted: "GPU",
            remedy: REMEDY,
            instead: INSTEAD,
        })
    }

    /// An adapter to draw on: a real GPU, else lavapipe.
    ///
    /// # Errors
    /// There is none.
    pub fn drawing() -> Result<Self, NoAdapter> {
        Self::real()
            .or_else(|_| Self::lavapipe())
            .map_err(|_| NoAdapter {
                wanted: "graphics adapter to draw with",
                remedy: REMEDY,
                instead: "",
            })
    }

    /// Mesa's software rasteriser. On Vulkan only: through OpenGL it is ten times slower.
    ///
    /// # Errors
    /// It is not installed.
    pub fn lavapipe() -> Result<Self, NoAdapter> {
        Self::shared(DeviceKind::Cpu, WgpuBackend::Vulkan).map_err(|_| NoAdapter {
            wanted: "software Vulkan adapter (lavapipe)",
            remedy: REMEDY,
            instead: INSTEAD,
        })
    }

    /// burn's runtime can be set up once a process and kind: later calls share the first one's.
    fn shared(kind: DeviceKind, api: WgpuBackend) -> Result<Self, WgpuInitError> {
        static OPENED: Mutex<Option<HashMap<DeviceKind, Gpu>>> = Mutex::new(None);
        let mut opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
        let opened = opened.get_or_insert_default();
        if let Some(gpu) = opened.get(&kind) {
            return Ok(gpu.clone());
        }
        let gpu = Self::new(kind.clone(), api)?;
        opened.insert(kind, gpu.clone());
        Ok(gpu)
    }

    fn new(kind: DeviceKind, api: WgpuBackend) -> Result<Self, WgpuInitError> {
        let software = kind == DeviceKind::Cpu;
        // One page an allocation: a dispatch may then bind two buffers, one read-only and one
        // read-write, without both being slices of the same page, which wgpu refuses.
        let (tensors, setup) = TensorDevice::wgpu_options()
            .device_kind(kind)
            .graphics_api(api)
            .memory_config(MemoryConfiguration::ExclusivePages)
            .init_with_setup()?;
        let (client, cube) = client_of(&tensors);
        let name = setup.adapter.get_info().name;
        let max_binding = setup.device.limits().max_storage_buffer_binding_size;
        Ok(Gpu {
            client,
            cube,
            tensors,
            setup,
            name,
            max_binding,
            software,
        })
    }

    /// Where burn keeps the tensors that go with this device.
    pub fn tensors(&self) -> TensorDevice {
        self.tensors.clone()
    }

    /// Waits until everything requested of the device is done.
    pub(super) fn sync(&self) -> anyhow::Result<()> {
        self.tensors
            .sync()
            .map_err(|error| anyhow::anyhow!("the GPU stopped: {error}"))
    }
}

/// The compute client behind a wgpu tensor device.
fn client_of(device: &TensorDevice) -> (Client, CubeDevice) {
    match Tensor::<1>::zeros([1], device).try_into_primitive::<Wgpu>() {
        Ok(tensor) => (tensor.client, tensor.device),
        Err(error) => unreachable!("tensors of a `Gpu` live on wgpu: {error:?}"),
    }
}
