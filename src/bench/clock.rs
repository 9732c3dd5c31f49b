//! Seconds of a call.

use super::bench_device::Place;
use anyhow::Result;
use std::time::Instant;

/// Seconds a measurement takes at least, after a first call that is not counted.
const ENOUGH_S: f64 = 0.3;
/// Calls of which the median counts, at least.
const CALLS: usize = 3;
/// Seconds of a call beyond which something is not worth measuring.
pub const TOO_LONG_S: f64 = 10.0;

/// What an item asks of the device at least; 0 where that is no fixed number.
#[derive(Clone, Copy, Default)]
pub struct Work {
    /// Bytes read and written.
    pub bytes: f64,
    /// Multiplications and additions.
    pub operations: f64,
}

/// The median of several calls, each waited for.
pub fn seconds(place: &Place, mut call: impl FnMut() -> Result<()>) -> Result<f64> {
    let begin = Instant::now();
    call()?;
    place.device.sync()?;
    // Where even that takes long, what a first call compiles and allocates hardly counts.
    if begin.elapsed().as_secs_f64() > TOO_LONG_S / 2.0 {
        return Ok(begin.elapsed().as_secs_f64());
    }
    let mut times = Vec::new();
    let begin = Instant::now();
    while times.len() < CALLS || begin.elapsed().as_secs_f64() < ENOUGH_S {
        let start = Instant::now();
        call()?;
        place.device.sync()?;
        times.push(start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    Ok(times[times.len() / 2])
}
