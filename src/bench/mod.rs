//! `footwork bench`: the speed of each stage on each device, beside what the device could do at most.
//!
//! [`bench_device`] is where a stage runs, [`clock`] how it is timed, [`roofline`] what the device can do
//! at most; [`data`] are databases of any size. The other modules are the stages.

mod bench_device;
mod clock;
mod data;
mod drawing;
mod environment;
mod learn;
mod roofline;
mod search;
mod training;

use crate::gpu::Choice;
use crate::matching::MotionMatcher;
use anyhow::{Result, ensure};
use bench_device::BenchDevice;
use roofline::Roofline;
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;

/// One measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measurement {
    /// One of [`STAGES`].
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

/// Names for `--filter`.
pub const STAGES: [&str; 10] = [
    "memory",
    "arithmetic",
    "search",
    "rasterize_maps",
    "hits",
    "environment",
    "network",
    "update",
    "training",
    "drawing",
];

/// What to measure.
pub struct BenchPlan<'a> {
    /// Stages with this in their name.
    pub filter: &'a str,
    /// `Auto`: every device there is.
    pub device: Choice,
    /// A database file, a BVH file or a folder of them.
    pub data: Option<&'a Path>,
}

impl BenchPlan<'_> {
    fn selects(&self, stage: &str) -> bool {
        stage.contains(self.filter)
    }
}

/// The measurements so far; `tell` hears what is under way.
struct Recorder<'a> {
    measurements: Vec<Measurement>,
    tell: &'a dyn Fn(&str),
}

/// Bytes and operations that an item costs at least; 0 where that is no fixed number.
#[derive(Clone, Copy, Default)]
struct ItemCost {
    /// Bytes read and written.
    bytes: f64,
    /// Multiplications and additions.
    operations: f64,
}

/// What is measured, beside the device.
struct Workload<'a> {
    stage: &'static str,
    variant: &'a str,
    frames: usize,
    envs: usize,
    batch: usize,
    bytes: Option<usize>,
    cost: ItemCost,
}

impl Recorder<'_> {
    fn add(&mut self, on: &BenchDevice, roofline: &Roofline, workload: Workload, seconds: f64) {
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

/// Measures what `plan` selects, on one device after another; `tell` hears what is under way.
///
/// # Errors
/// The data cannot be read, there is no such device or it was lost, or no stage matches the filter.
pub fn run(plan: &BenchPlan, tell: &dyn Fn(&str)) -> Result<Vec<Measurement>> {
    ensure!(
        STAGES.iter().any(|stage| plan.selects(stage)),
        "no stage is called like {}: there are {}",
        plan.filter,
        STAGES.join(", ")
    );
    let devices = BenchDevice::all(plan.device)?;
    let data = data::BenchData::load(plan.data)?;
    let mut record = Recorder {
        measurements: Vec::new(),
        tell,
    };
    let rooflines = devices
        .iter()
        .map(|on| roofline::measure(plan, on, &mut record))
        .collect::<Result<Vec<_>>>()?;
    let devices: Vec<_> = devices.iter().zip(&rooflines).collect();
    if plan.selects("search") {
        search::measure(&data, &devices, &mut record)?;
    }
    let matcher = Arc::new(MotionMatcher::new(data.database));
    for (on, roofline) in devices {
        let bench = Bench {
            plan,
            on,
            roofline,
            matcher: &matcher,
        };
        environment::measure(&bench, &mut record)?;
        learn::measure(&bench, &mut record)?;
        training::measure(&bench, &mut record)?;
        drawing::measure(&bench, &mut record)?;
    }
    Ok(record.measurements)
}

/// What the stages after the search share.
struct Bench<'a> {
    plan: &'a BenchPlan<'a>,
    on: &'a BenchDevice,
    roofline: &'a Roofline,
    matcher: &'a Arc<MotionMatcher>,
}

/// Environments of a batch.
const ENVS: [usize; 5] = [256, 1024, 4096, 16_384, 65_536];
