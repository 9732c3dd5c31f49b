//! Seconds of a call.

use super::bench_device::BenchDevice;
use anyhow::Result;
use std::time::Instant;

/// Seconds that a measurement takes at least, after a first call that is not counted.
const MIN_S: f64 = 0.3;
/// Calls whose median counts, at least.
const MIN_CALLS: usize = 3;
/// Seconds of a call beyond which larger sizes are not measured.
pub const MAX_CALL_S: f64 = 10.0;

/// The median of several calls, each waited for, s.
pub fn seconds(on: &BenchDevice, mut call: impl FnMut() -> Result<()>) -> Result<f64> {
    let begin = Instant::now();
    call()?;
    on.device.sync()?;
    // Where even that takes long, what a first call compiles and allocates hardly counts.
    if begin.elapsed().as_secs_f64() > MAX_CALL_S / 2.0 {
        return Ok(begin.elapsed().as_secs_f64());
    }
    let mut times = Vec::new();
    let begin = Instant::now();
    while times.len() < MIN_CALLS || begin.elapsed().as_secs_f64() < MIN_S {
        let start = Instant::now();
        call()?;
        on.device.sync()?;
        times.push(start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    Ok(times[times.len() / 2])
}
