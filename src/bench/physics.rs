//! Simulated humanoids under random targets: an action of all, and on a GPU each of its launches.

use super::clock::{MAX_CALL_S, seconds};
use super::recorder::{Recorder, Workload};
use super::roofline::ItemCost;
use super::stage::BenchContext;
use crate::env::humanoid::batch::{self, GpuSimulatorBatch, SimulatorBatch, SimulatorBatchConfig};
use crate::gpu::Device;
use crate::physics::scenes;
use crate::physics::simulator::SolverOptions;
use anyhow::Result;
use std::sync::Arc;
use std::time::Instant;

/// Environments of a batch.
const ENVS: [usize; 3] = [256, 1024, 4096];
/// Standard deviation of the drives' targets, rad.
const ACTION_STD: f32 = 0.5;
/// Actions until some have fallen, so that there are contacts of all kinds.
const WARM_UP: usize = 45;
/// Steps whose launches are timed.
const TIMED: usize = 10;

/// Measures rising numbers of environments.
pub fn measure(context: &BenchContext, record: &mut Recorder) -> Result<()> {
    if !context.plan.selects("physics") {
        return Ok(());
    }
    let model = Arc::new(scenes::humanoid());
    let mut last = 0.0;
    for envs in ENVS {
        if 4.0 * last > MAX_CALL_S {
            break;
        }
        let setup = SimulatorBatchConfig {
            options: SolverOptions::fast(&model),
            model: model.clone(),
            envs,
            seed: 1,
            force_pairs: Vec::new(),
        };
        last = actions(context, &setup, record)?;
        if let Device::Gpu(gpu) = &context.on.device
            && envs == ENVS[0]
        {
            launches(context, GpuSimulatorBatch::new(&setup, gpu)?, envs, record)?;
        }
    }
    Ok(())
}

/// Measures whole actions and returns the seconds of one.
fn actions(
    context: &BenchContext,
    setup: &SimulatorBatchConfig,
    record: &mut Recorder,
) -> Result<f64> {
    let BenchContext { on, roofline, .. } = *context;
    (record.tell)(&format!("{}: {} humanoids", on.name(), setup.envs));
    let time = on.install(|| -> Result<f64> {
        let mut batch = batch::open(&on.device, setup)?;
        warm_up(&mut *batch);
        seconds(on, || {
            batch.draw_targets(ACTION_STD);
            batch.step();
            Ok(())
        })
    })?;
    record.add(on, roofline, workload("humanoid", setup.envs), time);
    Ok(time)
}

fn warm_up(batch: &mut dyn SimulatorBatch) {
    for _ in 0..WARM_UP {
        batch.draw_targets(ACTION_STD);
        batch.step();
    }
}

/// Measures each launch of an action in its turn: repeated by itself it would find nothing left to do.
fn launches(
    context: &BenchContext,
    mut batch: GpuSimulatorBatch,
    envs: usize,
    record: &mut Recorder,
) -> Result<()> {
    let BenchContext { on, roofline, .. } = *context;
    warm_up(&mut batch);
    let mut taken = [0.0; GpuSimulatorBatch::LAUNCHES.len()];
    for _ in 0..TIMED {
        for ((_, launch), taken) in GpuSimulatorBatch::LAUNCHES.iter().zip(&mut taken) {
            on.device.sync()?;
            let start = Instant::now();
            launch(&batch, true);
            on.device.sync()?;
            *taken += start.elapsed().as_secs_f64() / TIMED as f64;
        }
    }
    for ((name, _), time) in GpuSimulatorBatch::LAUNCHES.into_iter().zip(taken) {
        record.add(on, roofline, workload(name, envs), time);
    }
    Ok(())
}

fn workload(variant: &str, envs: usize) -> Workload<'_> {
    Workload {
        stage: "physics",
        variant,
        frames: 0,
        envs,
        batch: envs,
        bytes: None,
        cost: ItemCost::default(),
    }
}
