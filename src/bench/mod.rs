//! `footwork bench`: the speed of each stage on each device, beside what the device could do at most.
//!
//! [`bench_device`] is where a stage runs, [`clock`] how it is timed, [`roofline`] what the device can do
//! at most ([`peak_rates`]); [`data`] are databases of any size. [`search`], [`environment`], [`network`],
//! [`physics`], [`self_play`], [`training`] and [`drawing`] are the stages.

mod bench_device;
mod clock;
mod data;
mod drawing;
mod environment;
mod network;
mod peak_rates;
mod physics;
mod plan;
mod recorder;
mod roofline;
mod search;
mod self_play;
mod stage;
mod training;

use crate::matching::MotionMatcher;
use anyhow::{Result, ensure};
use bench_device::BenchDevice;
pub use plan::{BenchPlan, STAGES};
pub use recorder::Measurement;
use recorder::Recorder;
use stage::BenchContext;
use std::sync::Arc;

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
        .map(|on| peak_rates::measure(plan, on, &mut record))
        .collect::<Result<Vec<_>>>()?;
    let devices: Vec<_> = devices.iter().zip(&rooflines).collect();
    if plan.selects("search") {
        search::measure(&data, &devices, &mut record)?;
    }
    let matcher = Arc::new(MotionMatcher::new(data.database));
    for (on, roofline) in devices {
        let context = BenchContext {
            plan,
            on,
            roofline,
            matcher: &matcher,
        };
        environment::measure(&context, &mut record)?;
        physics::measure(&context, &mut record)?;
        self_play::measure(&context, &mut record)?;
        network::measure(&context, &mut record)?;
        training::measure(&context, &mut record)?;
        drawing::measure(&context, &mut record)?;
    }
    Ok(record.measurements)
}
