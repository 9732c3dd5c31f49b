//! The networks of both tasks' preset `fast`: the policy's mean for many observations at once, and
//! learning from a whole rollout.

use super::clock::{MAX_CALL_S, seconds};
use super::training::{config, held};
use super::recorder::{Recorder, Workload};
use super::roofline::ItemCost;
use super::stage::{BenchContext, ENVS};
use crate::motion::features::TRAJECTORY_DIM;
use crate::nn::network::Shape;
use crate::rl::rollout::Rollout;
use crate::rl::ppo::update::Learner;
use crate::nn::tensors::read;
use crate::train::config::{Config, Kind, Preset};
use anyhow::{Context, Result};
use burn::tensor::{Device, Distribution, Tensor};

pub fn measure(bench: &BenchContext, record: &mut Recorder) -> Result<()> {
    for (stage, measure) in [("network", forward as Stage), ("update", update)] {
        if !bench.plan.selects(stage) {
            continue;
        }
        for kind in [Kind::Plane, Kind::Obstacles] {
            let mut last = 0.0;
            for envs in ENVS {
                if 4.0 * last > MAX_CALL_S || !held(bench, kind, envs) {
                    break;
                }
                last = measure(bench, kind, envs, record)?;
            }
        }
    }
    Ok(())
}

/// Measures with so many environments and returns the seconds it takes once.
type Stage = fn(&BenchContext, Kind, usize, &mut Recorder) -> Result<f64>;

fn forward(bench: &BenchContext, kind: Kind, envs: usize, record: &mut Recorder) -> Result<f64> {
    let BenchContext { on, roofline, .. } = *bench;
    let config = Config::preset(kind, Preset::Fast);
    let width = config.task.width();
    (record.tell)(&format!(
        "{}: network, {} of {envs}",
        on.name(),
        config.task.name()
    ));
    let shape = Shape::new(&config.ppo.network, width).context("a network")?;
    let time = on.install(|| -> Result<f64> {
        let tensors = on.device.tensors();
        let policy = Learner::new(&config.ppo, width, &on.device, 1)?.policy();
        let observation = Tensor::<2>::ones([envs, width], &tensors);
        seconds(on, || {
            let _ = policy.mean(observation.clone());
            Ok(())
        })
    })?;
    let workload = Workload {
        stage: "network",
        variant: config.task.name(),
        frames: 0,
        envs,
        batch: envs,
        bytes: Some(4 * shape.parameters()),
        cost: ItemCost {
            bytes: 0.0,
            operations: shape.actor_operations() as f64,
        },
    };
    record.add(on, roofline, workload, time);
    Ok(time)
}

/// An update from a rollout of noise.
fn update(bench: &BenchContext, kind: Kind, envs: usize, record: &mut Recorder) -> Result<f64> {
    let BenchContext { on, roofline, .. } = *bench;
    let config = config(kind, envs);
    let (ppo, width) = (&config.ppo, config.task.width());
    (record.tell)(&format!(
        "{}: update, {} of {envs}",
        on.name(),
        config.task.name()
    ));
    let shape = Shape::new(&ppo.network, width).context("a network")?;
    let time = on.install(|| -> Result<f64> {
        let tensors = on.device.tensors();
        let mut learner = Learner::new(ppo, width, &on.device, 1)?;
        let rollout = noise(ppo.batch(), width, &tensors);
        seconds(on, || {
            read(learner.update(&rollout, ppo))?;
            Ok(())
        })
    })?;
    let workload = Workload {
        stage: "update",
        variant: config.task.name(),
        frames: 0,
        envs,
        batch: ppo.batch(),
        bytes: Some(4 * 3 * shape.parameters()),
        cost: ItemCost {
            bytes: 0.0,
            // Forward, and twice as much back, in every pass.
            operations: (3 * ppo.epochs * shape.operations()) as f64,
        },
    };
    record.add(on, roofline, workload, time);
    Ok(time)
}

/// A rollout of `samples` that learning takes in as any other.
fn noise(samples: usize, width: usize, device: &Device) -> Rollout {
    let rows = |width: usize| {
        Tensor::<2>::random([samples, width], Distribution::Normal(0.0, 1.0), device)
    };
    let scalars = || rows(1).squeeze_dim::<1>(1);
    Rollout {
        observation: rows(width),
        action: rows(TRAJECTORY_DIM),
        mean: rows(TRAJECTORY_DIM),
        // About what such actions have.
        log_prob: scalars().sub_scalar(20.0),
        value: scalars(),
        advantage: scalars(),
        target: scalars(),
        log_std: Tensor::zeros([TRAJECTORY_DIM], device),
        act_s: 0.0,
        simulate_s: 0.0,
    }
}
