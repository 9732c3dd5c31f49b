//! The peak rates of a device: memory bandwidth and arithmetic.

use super::bench_device::BenchDevice;
use super::clock::seconds;
use super::plan::BenchPlan;
use super::recorder::{Recorder, Workload};
use super::roofline::{ItemCost, Roofline};
use crate::gpu::{Buffer, Device};
use crate::kernels::bench::{arithmetic, bandwidth};
use anyhow::Result;

/// Quadruples copied: 128 MiB, far beyond any cache but those of servers.
const COPIED: u32 = 1 << 23;
/// Quadruples added up, and how often. An invocation stays below lavapipe's 65,535 iterations.
const ADDED: u32 = 1 << 16;
const ROUNDS: u32 = 64;

/// Measures a device whatever the filter, but records that only if the filter selects it.
pub fn measure(plan: &BenchPlan, on: &BenchDevice, record: &mut Recorder) -> Result<Roofline> {
    (record.tell)(&format!("{}: memory, arithmetic", on.name()));
    let copy_s = copy(on)?;
    let add_s = add(on)?;
    let copied = 32.0 * f64::from(COPIED);
    let added = (arithmetic::OPERATIONS * u64::from(ADDED) * u64::from(ROUNDS)) as f64;
    let roofline = Roofline {
        bytes_per_s: copied / copy_s,
        operations_per_s: added / add_s,
    };
    for (stage, variant, items, time) in [
        ("memory", "bytes copied", copied, copy_s),
        ("arithmetic", "operations", added, add_s),
    ] {
        if plan.selects(stage) {
            let workload = Workload {
                stage,
                variant,
                frames: 0,
                envs: 0,
                batch: items as usize,
                bytes: None,
                cost: ItemCost::default(),
            };
            record.add(on, &roofline, workload, time);
        }
    }
    Ok(roofline)
}

fn copy(on: &BenchDevice) -> Result<f64> {
    let params = bandwidth::Params::new(COPIED);
    let source = vec![[1.0f32; 4]; COPIED as usize];
    if let Device::Gpu(gpu) = &on.device {
        let source = Buffer::from_slice(gpu, source.as_flattened());
        let copy = Buffer::zeroed(gpu, source.len());
        return seconds(on, || {
            bandwidth::launch(gpu, &source, &copy, &params);
            Ok(())
        });
    }
    let mut copy = vec![[0.0f32; 4]; COPIED as usize];
    on.install(|| {
        seconds(on, || {
            bandwidth::twin(&source, &mut copy, &params);
            Ok(())
        })
    })
}

fn add(on: &BenchDevice) -> Result<f64> {
    let params = arithmetic::Params {
        count: ADDED,
        rounds: ROUNDS,
    };
    let mut sums = vec![[1.0f32; 4]; ADDED as usize];
    if let Device::Gpu(gpu) = &on.device {
        let sums = Buffer::from_slice(gpu, sums.as_flattened());
        return seconds(on, || {
            arithmetic::launch(gpu, &sums, &params);
            Ok(())
        });
    }
    on.install(|| {
        seconds(on, || {
            arithmetic::twin(&mut sums, &params);
            Ok(())
        })
    })
}
