//! Whole training, an update at a time: worlds, networks, learning and the one read-back.

use super::clock::{TOO_LONG_S, Work, seconds};
use super::{Bench, ENVS, Item, Record};
use crate::motion::features::TRAJECTORY_DIM;
use crate::rl::rollout;
use crate::rl::ppo::update::Learner;
use crate::nn::tensors;
use crate::train::config::{Config, Kind, Preset};
use crate::env::locomotion::{Batch, Setup};
use anyhow::Result;

pub fn measure(bench: &Bench, record: &mut Record) -> Result<()> {
    if !bench.plan.wants("training") {
        return Ok(());
    }
    for kind in [Kind::Plane, Kind::Obstacles] {
        let mut last = 0.0;
        for envs in ENVS {
            if 4.0 * last > TOO_LONG_S || !held(bench, kind, envs) {
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
pub(super) fn held(bench: &Bench, kind: Kind, envs: usize) -> bool {
    let config = config(kind, envs);
    let numbers = config.ppo.batch() * (config.task.width() + 2 * TRAJECTORY_DIM + 4);
    bench.place.device.holds("samples", numbers).is_ok()
}

fn update(bench: &Bench, kind: Kind, envs: usize, record: &mut Record) -> Result<f64> {
    let Bench { place, ceiling, .. } = *bench;
    let config = config(kind, envs);
    let (task, ppo) = (config.task, &config.ppo);
    (record.tell)(&format!(
        "{}: training, {} of {envs}",
        place.name(),
        task.name()
    ));
    let setup = Setup {
        task,
        envs,
        horizon: ppo.horizon,
        seed: 1,
        level: 0,
    };
    let time = place.inside(|| -> Result<f64> {
        let mut batch = Batch::open(&place.device, bench.database, &setup);
        let mut learner = Learner::new(ppo, task.width(), &place.device, 1)?;
        seconds(place, || {
            let policy = learner.policy();
            let rollout =
                rollout::collect(&mut batch, &policy, &learner.scale, ppo, &place.device)?;
            tensors::read(learner.update(&rollout, ppo))?;
            Ok(())
        })
    })?;
    let item = Item {
        stage: "training",
        variant: task.name(),
        frames: bench.database.candidates.len(),
        envs,
        batch: ppo.batch(),
        bytes: None,
        work: Work::default(),
    };
    record.add(place, ceiling, item, time);
    Ok(time)
}
