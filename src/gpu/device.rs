//! Which adapter or processor runs the program.

use super::tensor;
use burn::tensor::wgpu::{MemoryConfiguration, WgpuBackend, WgpuInitError, WgpuSetup};
use burn::tensor::{Device as TensorDevice, DeviceKind};
use clap::ValueEnum;
use cubecl::client::Client;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

/// What the user asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Choice {
    /// A real GPU if there is one, else the native CPU path.
    #[default]
    Auto,
    /// The native CPU path: SIMD on all cores, networks by kernels of our own.
    Cpu,
    /// A real GPU: discrete, else integrated, else virtual.
    Gpu,
    /// Mesa's software Vulkan: the GPU path without a GPU, for tests.
    Lavapipe,
}

/// No adapter of the asked-for kind.
#[derive(Debug, thiserror::Error)]
#[error(
    "no {wanted} found: install a Vulkan, Metal or DX12 driver (Mesa's `mesa-vulkan-drivers` brings lavapipe){instead}"
)]
pub struct NoAdapter {
    wanted: &'static str,
    /// What else there is to do.
    instead: &'static str,
}

/// The networks and worlds need none.
const INSTEAD: &str = ", or use `--device cpu`";

/// An opened device.
#[derive(Clone)]
pub enum Device {
    Cpu,
    Gpu(Box<Gpu>),
}

/// A wgpu device that burn's tensors and this program's kernels share.
#[derive(Clone)]
pub struct Gpu {
    pub(super) client: Client,
    pub(super) cube: burn_cubecl::CubeDevice,
    tensors: TensorDevice,
    /// What burn runs on, for whoever draws on the same device.
    pub setup: WgpuSetup,
    /// The adapter's own name.
    pub name: String,
    /// Bytes a kernel can reach in one buffer.
    binding: u64,
    /// Lavapipe and its kind: eight lanes, cheap uniform loads, no fast workgroup memory.
    pub software: bool,
}

impl From<Gpu> for Device {
    fn from(gpu: Gpu) -> Self {
        Device::Gpu(Box::new(gpu))
    }
}

impl Device {
    /// Opens the device. `Choice::Auto` never fails.
    pub fn open(choice: Choice) -> Result<Self, NoAdapter> {
        match choice {
            Choice::Cpu => Ok(Device::Cpu),
            Choice::Gpu => Gpu::real().map(Device::from),
            Choice::Lavapipe => Gpu::lavapipe().map(Device::from),
            Choice::Auto => Ok(Gpu::real().map_or(Device::Cpu, Device::from)),
        }
    }

    /// What to ask for to get this device again.
    pub fn choice(&self) -> Choice {
        match self {
            Device::Cpu => Choice::Cpu,
            Device::Gpu(gpu) if gpu.software => Choice::Lavapipe,
            Device::Gpu(_) => Choice::Gpu,
        }
    }

    /// Where burn keeps the tensors that go with this device.
    pub fn tensors(&self) -> TensorDevice {
        match self {
            Device::Cpu => TensorDevice::flex(),
            Device::Gpu(gpu) => gpu.tensors.clone(),
        }
    }

    /// A name for logs and reports: the adapter's, or the number of CPU threads.
    pub fn name(&self) -> String {
        match self {
            Device::Cpu => format!("cpu ({} threads)", rayon::current_num_threads()),
            Device::Gpu(gpu) => gpu.name.clone(),
        }
    }

    /// Refuses an array of so many numbers that one buffer of a GPU cannot hold it.
    ///
    /// # Errors
    /// It is too large; the message says what and by how much.
    pub fn holds(&self, what: &str, numbers: usize) -> anyhow::Result<()> {
        let bytes = numbers as u64 * 4;
        match self {
            Device::Gpu(gpu) if bytes > gpu.binding => anyhow::bail!(
                "the {what} take {} MiB and {} reaches {} MiB of a buffer",
                bytes.div_ceil(1 << 20),
                gpu.name,
                gpu.binding >> 20
            ),
            _ => Ok(()),
        }
    }

    /// Waits for a software adapter, as [`Device::sync`] does, and for no other: where much is asked, the queue to
    /// it is always full, and for room in there cubecl waits spinning, on a core that the adapter could use.
    ///
    /// # Errors
    /// The device was lost or a kernel failed.
    pub fn pace(&self) -> anyhow::Result<()> {
        match self {
            Device::Gpu(gpu) if gpu.software => self.sync(),
            _ => Ok(()),
        }
    }

    /// Waits until everything asked of the device is done.
    ///
    /// # Errors
    /// The device was lost or a kernel failed.
    pub fn sync(&self) -> anyhow::Result<()> {
        match self {
            Device::Cpu => Ok(()),
            Device::Gpu(gpu) => gpu
                .tensors
                .sync()
                .map_err(|error| anyhow::anyhow!("the GPU stopped: {error}")),
        }
    }
}

impl Gpu {
    /// The first discrete, else integrated, else virtual GPU.
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
            instead: INSTEAD,
        })
    }

    /// To draw on: a real GPU, else lavapipe.
    pub fn drawing() -> Result<Self, NoAdapter> {
        Self::real()
            .or_else(|_| Self::lavapipe())
            .map_err(|_| NoAdapter {
                wanted: "graphics adapter to draw with",
                instead: "",
            })
    }

    /// Mesa's software rasteriser. On Vulkan only: through OpenGL it is ten times slower.
    pub fn lavapipe() -> Result<Self, NoAdapter> {
        Self::shared(DeviceKind::Cpu, WgpuBackend::Vulkan).map_err(|_| NoAdapter {
            wanted: "software Vulkan adapter (lavapipe)",
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
        let (client, cube) = tensor::client_of(&tensors);
        let name = setup.adapter.get_info().name;
        let binding = setup.device.limits().max_storage_buffer_binding_size;
        Ok(Gpu {
            client,
            cube,
            tensors,
            setup,
            name,
            binding,
            software,
        })
    }
}
