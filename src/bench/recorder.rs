//! Measurements, and what they are of.

use super::bench_device::BenchDevice;
use super::roofline::{ItemCost, Roofline};
use serde::Serialize;

/// One measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measurement {
    /// One of [`crate::bench::STAGES`].
    pub stage: &'static str,
    /// A variant of the stage, like `indexed`.
    pub variant: String,
    /// The adapter's name, or `cpu`.
    pub device: String,
    /// Threads of the CPU; lavapipe has its own, one a core.
    pub threads: usize,
    /// Candidates of the database.
    pub frames: usize,
    /// Environments; 0 where there are none.
    pub envs: usize,
    /// Items of one call: queries, environments, samples or steps.
    pub batch: usize,
    /// Items a second.
    pub per_s: f64,
    /// Memory that the stage needs for its arrays, where that is known.
    pub bytes: Option<usize>,
    /// Fraction of what the device's memory or arithmetic allows, where an item costs a fixed number of
    /// bytes or operations.
    pub roofline: Option<f64>,
}

/// The measurements so far; `tell` hears what is under way.
pub struct Recorder<'a> {
    pub measurements: Vec<Measurement>,
    pub tell: &'a dyn Fn(&str),
}

/// What is measured, beside the device.
pub struct Workload<'a> {
    pub stage: &'static str,
    pub variant: &'a str,
    pub frames: usize,
    pub envs: usize,
    pub batch: usize,
    pub bytes: Option<usize>,
    pub cost: ItemCost,
}

impl Recorder<'_> {
    /// Records the seconds that a workload took.
    pub fn add(&mut self, on: &BenchDevice, roofline: &Roofline, workload: Workload, seconds: f64) {
        let per_s = workload.batch as f64 / seconds;
        self.measurements.push(Measurement {
            stage: workload.stage,
            variant: workload.variant.to_string(),
            device: on.device_name(),
            threads: on.threads,
            frames: workload.frames,
            envs: workload.envs,
            batch: workload.batch,
            per_s,
            bytes: workload.bytes,
            roofline: roofline.fraction(workload.cost, per_s),
        });
    }
}
