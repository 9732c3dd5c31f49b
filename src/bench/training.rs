//! Whole training, an update at a time: environments, networks, learning and the one read-back.

use super::clock::{MAX_CALL_S, seconds};
use super::recorder::{Recorder, Workload};
use super::roofline::ItemCost;
use super::stage::{BenchContext, ENVS};
use crate::motion::features::TRAJECTORY_DIM;
use crate::rl::rollout;
use crate::rl::ppo::update::Learner;
use crate::nn::tensors;
use crate::train::config::{Config, Kind, Preset};
use crate::env::locomotion::{Batch, Setup};
use anyhow::Result;

pub fn measure(bench: &BenchContext, record: &mut Recorder) -> Result<()> {
    if !bench.plan.selects("training") {
        return Ok(());
    }
    for kind in [Kind::Plane, Kind::Obstacles] {
        let mut last = 0.0;
        for envs in ENVS {
            if 4.0 * last > MAX_CALL_S || !held(bench, kind, envs) {
                break;
            }
            last = update(bench, kind, envs, record)?;
        }
    }
    Ok(())
}

/// The preset `fast` with so many environments; minibatches grow with them.
pub(super) fn config(kind: Kind, envs: usize) -> Config {
    let mut config = Config::preset(kind, Preset::Fast);
    config.ppo.minibatch = config.ppo.minibatch * envs / config.ppo.envs;
    config.ppo.envs = envs;
    config
}

/// Whether the device reaches a rollout's observations, packed with what else a sample has.
pub(super) fn held(bench: &BenchContext, kind: Kind, envs: usize) -> bool {
    let config = config(kind, envs);
    let numbers = config.ppo.batch() * (config.task.width() + 2 * TRAJECTORY_DIM + 4);
    bench.on.device.holds("samples", numbers).is_ok()
}

fn update(bench: &BenchContext, kind: Kind, envs: usize, record: &mut Recorder) -> Result<f64> {
    let BenchContext { on, roofline, .. } = *bench;
    let config = config(kind, envs);
    let (task, ppo) = (config.task, &config.ppo);
    (record.tell)(&format!(
        "{}: training, {} of {envs}",
        on.name(),
        task.name()
    ));
    let setup = Setup {
        task,
        envs,
        horizon: ppo.horizon,
        seed: 1,
        level: 0,
    };
    let time = on.install(|| -> Result<f64> {
        let mut batch = Batch::open(&on.device, bench.matcher, &setup);
        let mut learner = Learner::new(ppo, task.width(), &on.device, 1)?;
        seconds(on, || {
            let policy = learner.policy();
            let rollout =
                rollout::collect(&mut batch, &policy, &learner.scale, ppo, &on.device)?;
            tensors::read(learner.update(&rollout, ppo))?;
            Ok(())
        })
    })?;
    let workload = Workload {
        stage: "training",
        variant: task.name(),
        frames: bench.matcher.database.candidates.len(),
        envs,
        batch: ppo.batch(),
        bytes: None,
        cost: ItemCost::default(),
    };
    record.add(on, roofline, workload, time);
    Ok(time)
}
