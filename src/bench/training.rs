//! Whole training, an update at a time: environments, networks, learning and the one read-back.

use super::clock::{MAX_CALL_S, seconds};
use super::recorder::{Recorder, Workload};
use super::roofline::ItemCost;
use super::stage::{BenchContext, ENVS};
use crate::env::EnvSpec;
use crate::env::locomotion::{EnvConfig, LocomotionTask, Obstacles, Plane};
use crate::kernels::learn::gather_samples::width;
use crate::rl::Algorithm;
use crate::rl::ppo::{Ppo, PpoLearner};
use crate::train::config::Preset;
use crate::train::tasks;
use anyhow::Result;

/// A task with the learning of its preset `fast`.
pub(super) struct Case {
    pub env: EnvConfig,
    pub ppo: Ppo,
}

impl Case {
    /// Both tasks with `envs` environments; minibatches grow with them.
    pub fn all(envs: usize) -> Result<Vec<Case>> {
        let tasks = [
            LocomotionTask::Plane(Plane::default()),
            LocomotionTask::Obstacles(Obstacles::FAST),
        ];
        let case = |task: LocomotionTask| {
            let mut ppo = tasks::find(task.name())?.config(Preset::Fast).ppo;
            ppo.minibatch_size = ppo.minibatch_size * envs / ppo.envs;
            ppo.envs = envs;
            let env = EnvConfig {
                task,
                envs,
                seed: 1,
                level: 0,
            };
            Ok(Case { env, ppo })
        };
        tasks.into_iter().map(case).collect()
    }

    pub fn name(&self) -> &'static str {
        self.env.task.name()
    }

    pub fn spec(&self) -> EnvSpec {
        self.env.spec()
    }

    /// Whether the device reaches the samples of an update.
    pub fn fits(&self, bench: &BenchContext) -> bool {
        let spec = self.spec();
        let numbers = self.ppo.batch() * width(spec.observation.dim(), spec.action);
        bench.on.device.holds("samples", numbers).is_ok()
    }
}

/// Runs `stage` for both tasks with more and more environments, until a call takes too long.
pub(super) fn each(
    bench: &BenchContext,
    mut stage: impl FnMut(&Case) -> Result<f64>,
) -> Result<()> {
    let mut last = [0.0; 2];
    for envs in ENVS {
        for (case, last) in Case::all(envs)?.iter().zip(&mut last) {
            if 4.0 * *last <= MAX_CALL_S && case.fits(bench) {
                *last = stage(case)?;
            }
        }
    }
    Ok(())
}

pub fn measure(bench: &BenchContext, record: &mut Recorder) -> Result<()> {
    match bench.plan.selects("training") {
        true => each(bench, |case| update(bench, case, record)),
        false => Ok(()),
    }
}

fn update(bench: &BenchContext, case: &Case, record: &mut Recorder) -> Result<f64> {
    let BenchContext { on, roofline, .. } = *bench;
    let envs = case.env.envs;
    (record.tell)(&format!("{}: training, {} of {envs}", on.name(), case.name()));
    let time = on.install(|| -> Result<f64> {
        let mut batch = case.env.open(&on.device, bench.matcher)?;
        let mut learner = PpoLearner::new(&case.ppo, &case.spec(), &on.device, 1)?;
        seconds(on, || learner.iterate(&mut batch, 0).map(|_| ()))
    })?;
    let workload = Workload {
        stage: "training",
        variant: case.name(),
        frames: bench.matcher.database.candidates.len(),
        envs,
        batch: case.ppo.batch(),
        bytes: None,
        cost: ItemCost::default(),
    };
    record.add(on, roofline, workload, time);
    Ok(time)
}
