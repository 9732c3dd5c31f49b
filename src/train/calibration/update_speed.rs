//! The speed of whole updates: environments, networks and learning.

use crate::gpu::Device;
use crate::ranks::Ranks;
use crate::train::config::Config;
use crate::train::task::Task;
use anyhow::Result;
use std::time::Instant;

/// Seconds that updates are measured for, after a first one: on a GPU that compiles, which may take longer than they do.
const MEASURED_S: f64 = 1.0;

/// Environment steps a second of a training that has just begun.
///
/// # Errors
/// The device cannot hold it, or was lost.
pub fn steps_per_s(task: &dyn Task, config: &Config, device: &Device) -> Result<f64> {
    // On a thread of the pool, as a training is.
    rayon::scope(|_| {
        let mut envs = task.open(device, &Ranks::alone(), config.ppo.envs, config.seed)?;
        let mut learner = task.learner(config, &envs, device)?;
        let mut steps = 0;
        let mut update = || -> Result<()> {
            learner.iterate(&mut envs, steps)?;
            steps += config.batch();
            device.sync()
        };
        update()?;
        let (begin, mut updates) = (Instant::now(), 0);
        while begin.elapsed().as_secs_f64() < MEASURED_S {
            update()?;
            updates += 1;
        }
        Ok((updates * config.batch()) as f64 / begin.elapsed().as_secs_f64())
    })
}
