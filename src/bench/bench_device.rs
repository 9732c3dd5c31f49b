//! Where something runs: one core, all cores, lavapipe, a real GPU.

use crate::gpu::{Choice, Device};
use anyhow::{Context, Result};

pub struct Place {
    pub device: Device,
    pub threads: usize,
    /// Stands for all cores, or for one.
    pool: rayon::ThreadPool,
}

/// Every place of this kind; all there are for `Auto`.
pub fn all(choice: Choice) -> Result<Vec<Place>> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut places = Vec::new();
    if matches!(choice, Choice::Auto | Choice::Cpu) {
        places.push(Place::new(Device::Cpu, 1)?);
        if cores > 1 {
            places.push(Place::new(Device::Cpu, cores)?);
        }
    }
    for kind in [Choice::Lavapipe, Choice::Gpu] {
        match Device::open(kind) {
            Ok(device) if matches!(choice, Choice::Auto) || choice == kind => {
                places.push(Place::new(device, cores)?);
            }
            Err(error) if choice == kind => return Err(error.into()),
            _ => {}
        }
    }
    Ok(places)
}

impl Place {
    fn new(device: Device, threads: usize) -> Result<Self> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        Ok(Place {
            device,
            threads,
            pool: pool.context("cannot start threads")?,
        })
    }

    /// With this many threads.
    pub fn inside<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.pool.install(work)
    }

    pub fn device_name(&self) -> String {
        match &self.device {
            Device::Cpu => "cpu".to_string(),
            Device::Gpu(gpu) => gpu.name.clone(),
        }
    }

    /// For people.
    pub fn name(&self) -> String {
        match (&self.device, self.threads) {
            (Device::Cpu, 1) => "cpu, one core".to_string(),
            (Device::Cpu, threads) => format!("cpu, {threads} cores"),
            (Device::Gpu(gpu), _) if gpu.software => "lavapipe".to_string(),
            (Device::Gpu(gpu), _) => gpu.name.clone(),
        }
    }
}
