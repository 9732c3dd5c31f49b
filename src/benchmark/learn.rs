//! The policy network of both tasks' preset `fast`: its mean for many observations at once.

use super::clock::{TOO_LONG_S, Work, seconds};
use super::{Bench, ENVS, Item, Record};
use crate::ppo::network::Shape;
use crate::ppo::update::Learner;
use crate::train::config::{Config, Kind, Preset};
use anyhow::{Context, Result};
use burn::tensor::Tensor;

pub fn measure(bench: &Bench, record: &mut Record) -> Result<()> {
    if !bench.plan.wants("network") {
        return Ok(());
    }
    for kind in [Kind::Plane, Kind::Obstacles] {
        let mut last = 0.0;
        for envs in ENVS {
            let numbers = envs * Config::preset(kind, Preset::Fast).task.width();
            let held = bench.place.device.holds("observations", numbers).is_ok();
            if 4.0 * last > TOO_LONG_S || !held {
                break;
            }
            last = forward(bench, kind, envs, record)?;
        }
    }
    Ok(())
}

fn forward(bench: &Bench, kind: Kind, envs: usize, record: &mut Record) -> Result<f64> {
    let Bench { place, ceiling, .. } = *bench;
    let config = Config::preset(kind, Preset::Fast);
    let width = config.task.width();
    (record.tell)(&format!(
        "{}: network, {} of {envs}",
        place.name(),
        config.task.name()
    ));
    let shape = Shape::new(&config.ppo.network, width).context("a network")?;
    let time = place.inside(|| -> Result<f64> {
        let tensors = place.device.tensors();
        let policy = Learner::new(&config.ppo, width, &tensors, 1)?.policy();
        let observation = Tensor::<2>::ones([envs, width], &tensors);
        seconds(place, || {
            let _ = policy.mean(observation.clone());
            Ok(())
        })
    })?;
    let item = Item {
        stage: "network",
        variant: config.task.name(),
        frames: 0,
        envs,
        batch: envs,
        bytes: Some(4 * shape.parameters()),
        work: Work {
            bytes: 0.0,
            operations: shape.actor_operations() as f64,
        },
    };
    record.add(place, ceiling, item, time);
    Ok(time)
}
