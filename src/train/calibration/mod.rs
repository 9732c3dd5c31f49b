//! Which device trains quickest here, and in how many environments: found by measuring whole updates.
//!
//! [`choice`] decides from speeds alone, [`update_speed`] measures one, [`kept`] keeps them for later trainings.

mod choice;
mod kept;
mod update_speed;

use super::config::Config;
use super::memory;
use super::task::{Task, TaskEntry};
use crate::gpu::Device;
use anyhow::{Result, bail};
pub use choice::Speed;
use choice::{choose, grow, reason};
use kept::{KeptSpeeds, Workload};
use update_speed::steps_per_s;

/// The most environments that are tried on a processor.
const MOST_ON_CPU: usize = 16_384;
/// The most that are tried on a GPU.
const MOST_ON_GPU: usize = 65_536;

/// The configuration of a training in the given number of environments, or in that which it has by itself.
pub type Configure<'a> = &'a dyn Fn(Option<usize>) -> Result<Config>;

/// What is to be compared.
pub struct Calibration<'a> {
    /// The task by name.
    pub entry: &'a TaskEntry,
    /// The task with its data.
    pub task: &'a dyn Task,
    /// The training's configuration.
    pub configure: Configure<'a>,
    /// The devices; of two as quick the first is chosen.
    pub devices: &'a [Device],
    /// Whether more environments than the configuration has by itself are compared, too.
    pub grow: bool,
    /// Whether what was measured before is measured again.
    pub anew: bool,
    /// Hears what is found.
    pub tell: &'a dyn Fn(&str),
}

/// What was found.
pub struct Calibrated {
    /// All speeds, device by device.
    pub speeds: Vec<Speed>,
    /// What is best.
    pub chosen: Speed,
    /// Why.
    pub reason: String,
}

impl Calibration<'_> {
    /// Measures what is not known, keeps it, and chooses.
    ///
    /// # Errors
    /// No device can do it, or the configuration is of no use.
    pub fn run(&self) -> Result<Calibrated> {
        let mut kept = KeptSpeeds::open(kept::file(), self.tell);
        let mut speeds = Vec::new();
        for device in self.devices {
            match self.speeds(device, &mut kept) {
                Ok(own) => speeds.extend(own),
                Err(error) if self.devices.len() == 1 => return Err(error),
                Err(error) => (self.tell)(&format!("note: not on {}: {error:#}", device.name())),
            }
        }
        kept.save(self.tell);
        let Some(chosen) = choose(&speeds) else {
            bail!("none of the devices can do this: try fewer environments");
        };
        Ok(Calibrated {
            reason: reason(chosen, &speeds),
            speeds,
            chosen,
        })
    }

    fn config(&self, envs: usize) -> Result<Config> {
        (self.configure)(self.grow.then_some(envs))
    }

    /// The speeds of a device.
    fn speeds(&self, device: &Device, kept: &mut KeptSpeeds) -> Result<Vec<Speed>> {
        let first = (self.configure)(None)?.ppo.envs;
        let most = match device {
            _ if !self.grow => first,
            Device::Cpu => MOST_ON_CPU,
            Device::Gpu(_) => MOST_ON_GPU,
        };
        grow(first, most, |envs| {
            let speed = self.speed(device, envs, kept);
            speed.inspect_err(|error| {
                if envs > first {
                    (self.tell)(&format!("note: not {envs} environments: {error:#}"));
                }
            })
        })
    }

    /// The speed of so many environments, as it was kept or as it is now.
    fn speed(&self, device: &Device, envs: usize, kept: &mut KeptSpeeds) -> Result<Speed> {
        let config = self.config(envs)?;
        memory::check_training(device, &self.entry.check(&config)?, &config)?;
        let workload = Workload::new(device, &config, self.task.fingerprint());
        let known = kept.find(&workload).filter(|_| !self.anew);
        let steps_per_s = match known {
            Some(speed) => speed,
            None => steps_per_s(self.task, &config, device)?,
        };
        (self.tell)(&format!(
            "  {envs} environments on {}: {steps_per_s:.0} steps/s{}",
            device.name(),
            if known.is_some() {
                ", as measured before"
            } else {
                ""
            }
        ));
        kept.put(workload, steps_per_s);
        Ok(Speed {
            device: device.choice(),
            envs,
            steps_per_s,
        })
    }
}
