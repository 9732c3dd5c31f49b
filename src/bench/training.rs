//! Whole training, an update at a time: environments, networks, learning and the one read-back.

use super::clock::{MAX_CALL_S, seconds};
use super::recorder::{Recorder, Workload};
use super::roofline::ItemCost;
use super::stage::{BenchContext, ENVS};
use crate::env::locomotion::{EnvConfig, LocomotionTask, Obstacles, Plane};
use crate::kernels::learn::gather_samples::width;
use crate::rl::Algorithm;
use crate::rl::ppo::{Ppo, PpoLearner};
use crate::train::config::Base;
use crate::train::tasks::find;
use anyhow::Result;

/// Measures the motion-matching tasks in rising numbers of environments.
pub fn measure(context: &BenchContext, record: &mut Recorder) -> Result<()> {
    if !context.plan.selects("training") {
        return Ok(());
    }
    let tasks = [
        LocomotionTask::Plane(Plane::default()),
        LocomotionTask::Obstacles(Obstacles::FAST),
    ];
    for task in tasks {
        let mut last = 0.0;
        for envs in ENVS {
            let config = EnvConfig {
                task,
                envs,
                seed: 1,
                level: 0,
            };
            let ppo = ppo(task.name(), envs)?;
            let spec = config.spec();
            let numbers = ppo.batch() * width(spec.observation.dim(), spec.action, 1);
            let fits = context.on.device.holds("samples", numbers).is_ok();
            if 4.0 * last > MAX_CALL_S || !fits {
                break;
            }
            last = update(context, &config, &ppo, record)?;
        }
    }
    Ok(())
}

/// The preset `fast` in so many environments.
fn ppo(task: &str, envs: usize) -> Result<Ppo> {
    let base = Base {
        envs: Some(envs),
        ..Base::default()
    };
    Ok(find(task)?.config_of(base).ppo)
}

/// Measures updates and returns the seconds of one.
fn update(
    context: &BenchContext,
    config: &EnvConfig,
    ppo: &Ppo,
    record: &mut Recorder,
) -> Result<f64> {
    let BenchContext { on, roofline, .. } = *context;
    let (name, envs) = (config.task.name(), config.envs);
    (record.tell)(&format!("{}: training, {name} of {envs}", on.name()));
    let time = on.install(|| -> Result<f64> {
        let mut batch = config.open(&on.device, context.matcher)?;
        let mut learner = PpoLearner::new(ppo, &batch, &on.device, 1)?;
        seconds(on, || learner.iterate(&mut batch, 0).map(drop))
    })?;
    let workload = Workload {
        stage: "training",
        variant: name,
        frames: context.matcher.database.candidates.len(),
        envs,
        batch: ppo.batch(),
        bytes: None,
        cost: ItemCost::default(),
    };
    record.add(on, roofline, workload, time);
    Ok(time)
}
