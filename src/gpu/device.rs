//! Which adapter or processor runs the program.

use super::Gpu;
use super::no_adapter::NoAdapter;
use serde::{Deserialize, Serialize};
use std::fmt::{Display, Formatter};

/// What the user requests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Choice {
    /// A real GPU if there is one, else the native CPU path; trainings take the quicker of them, as measured.
    #[default]
    Auto,
    /// The native CPU path: SIMD on all cores, networks by custom CPU kernels.
    Cpu,
    /// A real GPU: discrete, else integrated, else virtual.
    Gpu,
    /// Mesa's software Vulkan: the GPU path without a GPU, for tests.
    Lavapipe,
}

impl Display for Choice {
    fn fmt(&self, f: &mut Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Choice::Auto => "auto",
            Choice::Cpu => "cpu",
            Choice::Gpu => "gpu",
            Choice::Lavapipe => "lavapipe",
        })
    }
}

/// An opened device.
#[derive(Clone)]
pub enum Device {
    /// The CPU, all cores.
    Cpu,
    /// A graphics adapter, real or software.
    Gpu(Box<Gpu>),
}

impl From<Gpu> for Device {
    fn from(gpu: Gpu) -> Self {
        Device::Gpu(Box::new(gpu))
    }
}

impl Device {
    /// Opens the device. `Choice::Auto` never fails.
    ///
    /// # Errors
    /// There is no adapter of that kind.
    pub fn open(choice: Choice) -> Result<Self, NoAdapter> {
        match choice {
            Choice::Cpu => Ok(Device::Cpu),
            Choice::Gpu => Gpu::real().map(Device::from),
            Choice::Lavapipe => Gpu::lavapipe().map(Device::from),
            Choice::Auto => Ok(Gpu::real().map_or(Device::Cpu, Device::from)),
        }
    }

    /// Opens every device that a choice leaves open: for `Choice::Auto` the CPU, and a real GPU if there is one.
    ///
    /// # Errors
    /// There is no adapter of that kind.
    pub fn all(choice: Choice) -> Result<Vec<Self>, NoAdapter> {
        let mut all = vec![Self::open(match choice {
            Choice::Auto => Choice::Cpu,
            named => named,
        })?];
        if choice == Choice::Auto {
            all.extend(Gpu::real().map(Device::from));
        }
        Ok(all)
    }

    /// The choice that opens this device again.
    pub fn choice(&self) -> Choice {
        match self {
            Device::Cpu => Choice::Cpu,
            Device::Gpu(gpu) if gpu.software => Choice::Lavapipe,
            Device::Gpu(_) => Choice::Gpu,
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
            Device::Gpu(gpu) if bytes > gpu.max_binding => anyhow::bail!(
                "the {what} take {} MiB and {} reaches {} MiB of a buffer",
                bytes.div_ceil(1 << 20),
                gpu.name,
                gpu.max_binding >> 20
            ),
            _ => Ok(()),
        }
    }

    /// Waits for a software adapter, as [`Device::sync`] does, and for no other: where much is requested,
    /// the queue to it is always full, and for room in there cubecl waits spinning, on a core that the
    /// adapter could use.
    ///
    /// # Errors
    /// The device was lost or a kernel failed.
    pub fn pace(&self) -> anyhow::Result<()> {
        match self {
            Device::Gpu(gpu) if gpu.software => self.sync(),
            _ => Ok(()),
        }
    }

    /// Waits until everything requested of the device is done.
    ///
    /// # Errors
    /// The device was lost or a kernel failed.
    pub fn sync(&self) -> anyhow::Result<()> {
        match self {
            Device::Cpu => Ok(()),
            Device::Gpu(gpu) => gpu.sync(),
        }
    }
}
