//! Where a stage runs: one core, all cores, lavapipe, a real GPU.

use crate::gpu::{Choice, Device};
use anyhow::{Context, Result};

/// A device to measure on, with a pool of threads.
pub struct BenchDevice {
    pub device: Device,
    /// Threads of the CPU; lavapipe has its own, one a core.
    pub threads: usize,
    pool: rayon::ThreadPool,
}

impl BenchDevice {
    /// The devices of this kind; all there are for `Auto`.
    ///
    /// # Errors
    /// There is none of this kind, or threads cannot be started.
    pub fn all(choice: Choice) -> Result<Vec<Self>> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let mut all = Vec::new();
        if matches!(choice, Choice::Auto | Choice::Cpu) {
            all.push(Self::new(Device::Cpu, 1)?);
            if cores > 1 {
                all.push(Self::new(Device::Cpu, cores)?);
            }
        }
        for kind in [Choice::Lavapipe, Choice::Gpu] {
            match Device::open(kind) {
                Ok(device) if matches!(choice, Choice::Auto) || choice == kind => {
                    all.push(Self::new(device, cores)?);
                }
                Err(error) if choice == kind => return Err(error.into()),
                _ => {}
            }
        }
        Ok(all)
    }

    fn new(device: Device, threads: usize) -> Result<Self> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        Ok(BenchDevice {
            device,
            threads,
            pool: pool.context("cannot start threads")?,
        })
    }

    /// Runs `work` with this many threads.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.pool.install(work)
    }

    /// The adapter's name, or `cpu`.
    pub fn device_name(&self) -> String {
        match &self.device {
            Device::Cpu => "cpu".to_string(),
            Device::Gpu(gpu) => gpu.name.clone(),
        }
    }

    /// A name for people.
    pub fn name(&self) -> String {
        match (&self.device, self.threads) {
            (Device::Cpu, 1) => "cpu, one core".to_string(),
            (Device::Cpu, threads) => format!("cpu, {threads} cores"),
            (Device::Gpu(gpu), _) if gpu.software => "lavapipe".to_string(),
            (Device::Gpu(gpu), _) => gpu.name.clone(),
        }
    }
}
