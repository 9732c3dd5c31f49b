//! `footwork bench`: what each device makes of each stage, beside what it could do at most.
//!
//! [`bench_device`] is where something runs, [`clock`] how it is timed, [`roofline`] what the place can do at most;
//! [`data`] are databases of any size; [`search`], [`world`], [`learn`] and [`training`] are the stages.

mod roofline;
mod clock;
mod data;
mod learn;
mod bench_device;
mod search;
mod training;
mod world;

use crate::gpu::Choice;
use crate::motion::database::Database;
use anyhow::{Result, ensure};
use roofline::Ceiling;
use clock::Work;
use bench_device::Place;
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;

/// One measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// One of [`STAGES`].
    pub stage: &'static str,
    /// What of it, like `indexed`.
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
    /// Share of what the device's memory or arithmetic allows at most, where the work of an item is
    /// a fixed number of bytes or operations.
    pub roofline: Option<f64>,
}

/// Names for `--filter`.
pub const STAGES: [&str; 9] = [
    "memory",
    "arithmetic",
    "search",
    "rasterise",
    "hits",
    "environment",
    "network",
    "update",
    "training",
];

/// What to measure.
pub struct Plan<'a> {
    /// Stages with this in their name.
    pub filter: &'a str,
    /// `Auto`: every device there is.
    pub device: Choice,
    pub data: Option<&'a Path>,
}

impl Plan<'_> {
    fn wants(&self, stage: &str) -> bool {
        stage.contains(self.filter)
    }
}

/// Rows so far; each is also told to whoever waits.
struct Record<'a> {
    rows: Vec<Row>,
    tell: &'a dyn Fn(&str),
}

/// What a row says beside its place and its speed.
struct Item<'a> {
    stage: &'static str,
    variant: &'a str,
    frames: usize,
    envs: usize,
    batch: usize,
    bytes: Option<usize>,
    work: Work,
}

impl Record<'_> {
    fn add(&mut self, place: &Place, ceiling: &Ceiling, item: Item, seconds: f64) {
        let per_s = item.batch as f64 / seconds;
        self.rows.push(Row {
            stage: item.stage,
            variant: item.variant.to_string(),
            device: place.device_name(),
            threads: place.threads,
            frames: item.frames,
            envs: item.envs,
            batch: item.batch,
            per_s,
            bytes: item.bytes,
            roofline: ceiling.share(item.work, per_s),
        });
    }
}

/// Measures what `plan` asks for, on one device after another; `tell` hears what is under way.
///
/// # Errors
/// The data cannot be read, there is no such device or it was lost, or nothing is called like the filter.
pub fn run(plan: &Plan, tell: &dyn Fn(&str)) -> Result<Vec<Row>> {
    ensure!(
        STAGES.iter().any(|stage| plan.wants(stage)),
        "no stage is called like {}: there are {}",
        plan.filter,
        STAGES.join(", ")
    );
    let places = bench_device::all(plan.device)?;
    let motion = data::Motion::load(plan.data)?;
    let mut record = Record {
        rows: Vec::new(),
        tell,
    };
    let ceilings = places
        .iter()
        .map(|place| roofline::measure(plan, place, &mut record))
        .collect::<Result<Vec<_>>>()?;
    let places: Vec<_> = places.iter().zip(&ceilings).collect();
    if plan.wants("search") {
        search::measure(&motion, &places, &mut record)?;
    }
    let database: Arc<Database> = motion.whole();
    for (place, ceiling) in places {
        let bench = Bench {
            plan,
            place,
            ceiling,
            database: &database,
        };
        world::measure(&bench, &mut record)?;
        learn::measure(&bench, &mut record)?;
        training::measure(&bench, &mut record)?;
    }
    Ok(record.rows)
}

/// What the stages behind the search share.
struct Bench<'a> {
    plan: &'a Plan<'a>,
    place: &'a Place,
    ceiling: &'a Ceiling,
    database: &'a Arc<Database>,
}

/// Environments of a batch.
const ENVS: [usize; 5] = [256, 1024, 4096, 16_384, 65_536];
