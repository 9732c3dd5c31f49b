//! What a device can do at most: the roofline.

use super::clock::{Work, seconds};
use super::bench_device::Place;
use super::{Item, Plan, Record};
use crate::gpu::{Buffer, Device};
use crate::kernels::bench::{arithmetic, bandwidth};
use anyhow::Result;

pub struct Ceiling {
    bytes_per_s: f64,
    operations_per_s: f64,
}

/// Quadruples copied: 128 MiB, far beyond any cache but those of servers.
const COPIED: u32 = 1 << 23;
/// Quadruples added up, and how often. An invocation stays below lavapipe's 65,535 iterations.
const ADDED: u32 = 1 << 16;
const ROUNDS: u32 = 64;

impl Ceiling {
    /// Of what memory or arithmetic allow, whichever is nearer.
    pub fn share(&self, work: Work, per_s: f64) -> Option<f64> {
        let bytes = work.bytes * per_s / self.bytes_per_s;
        let operations = work.operations * per_s / self.operations_per_s;
        Some(bytes.max(operations)).filter(|&share| share > 0.0)
    }
}

/// Measured whatever the filter, but only written down if it asks for it.
pub fn measure(plan: &Plan, place: &Place, record: &mut Record) -> Result<Ceiling> {
    (record.tell)(&format!("{}: memory, arithmetic", place.name()));
    let copy_s = copy(place)?;
    let add_s = add(place)?;
    let copied = 32.0 * f64::from(COPIED);
    let added = (arithmetic::OPERATIONS * u64::from(ADDED) * u64::from(ROUNDS)) as f64;
    let ceiling = Ceiling {
        bytes_per_s: copied / copy_s,
        operations_per_s: added / add_s,
    };
    for (stage, variant, items, time) in [
        ("memory", "bytes copied", copied, copy_s),
        ("arithmetic", "operations", added, add_s),
    ] {
        if plan.wants(stage) {
            let item = Item {
                stage,
                variant,
                frames: 0,
                envs: 0,
                batch: items as usize,
                bytes: None,
                work: Work::default(),
            };
            record.add(place, &ceiling, item, time);
        }
    }
    Ok(ceiling)
}

fn copy(place: &Place) -> Result<f64> {
    let params = bandwidth::Params::new(COPIED);
    let source = vec![[1.0f32; 4]; COPIED as usize];
    if let Device::Gpu(gpu) = &place.device {
        let source = Buffer::from_slice(gpu, source.as_flattened());
        let copy = Buffer::zeroed(gpu, source.len());
        return seconds(place, || {
            bandwidth::launch(gpu, &source, &copy, &params);
            Ok(())
        });
    }
    let mut copy = vec![[0.0f32; 4]; COPIED as usize];
    place.inside(|| {
        seconds(place, || {
            bandwidth::twin(&source, &mut copy, &params);
            Ok(())
        })
    })
}

fn add(place: &Place) -> Result<f64> {
    let params = arithmetic::Params {
        count: ADDED,
        rounds: ROUNDS,
    };
    let mut sums = vec![[1.0f32; 4]; ADDED as usize];
    if let Device::Gpu(gpu) = &place.device {
        let sums = Buffer::from_slice(gpu, sums.as_flattened());
        return seconds(place, || {
            arithmetic::launch(gpu, &sums, &params);
            Ok(())
        });
    }
    place.inside(|| {
        seconds(place, || {
            arithmetic::twin(&mut sums, &params);
            Ok(())
        })
    })
}
