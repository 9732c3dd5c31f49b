//! The task `plane`: reach a target on an empty plane.

use super::presets::paper;
use crate::env::locomotion::{LocomotionTask, Plane};
use crate::env::{EnvBatch, EnvSpec};
use crate::gpu::Device;
use crate::motion::normalise::Weights;
use crate::nn::Policy;
use crate::ranks::Ranks;
use crate::rl::ppo::Ppo;
use crate::train::config::{Config, ConfigError, Preset, TaskPreset, within};
use crate::train::evaluate::hardest;
use crate::train::evaluation::{EvalOptions, EvalReport, Evaluation};
use crate::train::fingerprint::Fingerprint;
use crate::train::locomotion::{Locomotion, rollout_spec, split, with_weights};
use crate::train::task::{Loaded, Task, TaskEntry, Unsupported};
#[cfg(feature = "report")]
use crate::train::{figures, metrics::UpdateMetrics, run_dir::RunDir};
use anyhow::Result;
#[cfg(feature = "report")]
use std::path::PathBuf;

/// The task in the registry.
pub const ENTRY: TaskEntry = TaskEntry {
    name: "plane",
    about: "Reach a target on an empty plane",
    preset,
    steering: None,
    spec,
    takes_motions: false,
    load,
    with_recordings: None,
    ablations: &[],
};

/// Steps at which the paper shows its policies (figure 4).
const MILESTONES: [u64; 4] = [20_000, 100_000, 533_000, 1_000_000];

fn preset(preset: Preset) -> TaskPreset {
    TaskPreset {
        settings: with_weights(&Plane::default(), Weights::PAPER),
        ppo: match preset {
            Preset::Fast => Ppo::default(),
            Preset::Paper => paper(),
        },
        amp: None,
        ase: None,
        self_play: None,
        steps: 1_000_000,
    }
}

fn spec(config: &Config) -> Result<EnvSpec, ConfigError> {
    let (plane, _) = split::<Plane>(config)?;
    within("task.target_extent", plane.target_extent, 0.1, 1000.0)?;
    within("task.success_radius", plane.success_radius, 0.001, 1000.0)?;
    within("task.success_bonus", plane.success_bonus, -1e6, 1e6)?;
    within("task.max_steps", plane.max_steps, 1, 10_000)?;
    if plane.success_radius >= plane.target_extent {
        return Err(ConfigError::Value {
            key: "task.success_radius",
            value: plane.success_radius.to_string(),
            why: "no target can be drawn: it must be less than task.target_extent".into(),
        });
    }
    rollout_spec(LocomotionTask::Plane(plane), config)
}

fn load(config: &Config) -> Result<Loaded> {
    let (plane, weights) = split::<Plane>(config)?;
    let (locomotion, notes) = Locomotion::load(LocomotionTask::Plane(plane), weights, config)?;
    let task = Box::new(PlaneTask { plane, locomotion });
    Ok(Loaded { task, notes })
}

struct PlaneTask {
    plane: Plane,
    locomotion: Locomotion,
}

impl Task for PlaneTask {
    fn settings(&self) -> toml::Table {
        with_weights(&self.plane, self.locomotion.matcher.database.weights)
    }

    fn with_choices(&self, config: &Config) -> Result<Box<dyn Task>, ConfigError> {
        let (plane, _) = split::<Plane>(config)?;
        let locomotion = self.locomotion.with_task(LocomotionTask::Plane(plane));
        Ok(Box::new(PlaneTask { plane, locomotion }))
    }

    fn fingerprint(&self) -> Fingerprint {
        self.locomotion.matcher.database.fingerprint.into()
    }

    fn describe(&self) -> String {
        self.locomotion.describe()
    }

    fn open(&self, device: &Device, ranks: &Ranks, envs: usize, seed: u32) -> Result<EnvBatch> {
        self.locomotion.open(device, ranks, envs, seed)
    }

    fn evaluate(&self, policy: &Policy, episodes: usize) -> Result<Evaluation> {
        self.locomotion.evaluate(policy, episodes)
    }

    fn sentence(&self, found: &Evaluation) -> String {
        format!(
            "{:.1} % of {} episodes reach the target, in {:.2} s on average",
            100.0 * found.success,
            found.episodes,
            found.measure("time_to_target_mean_s")
        )
    }

    fn report(&self, policy: &Policy, wanted: &EvalOptions) -> Result<EvalReport> {
        if wanted.planner > 0 {
            let why = "--planner is for runs among obstacles: on the plane nothing is in the way";
            return Err(Unsupported(why.into()).into());
        }
        let Locomotion { task, matcher } = &self.locomotion;
        let trained = hardest(policy, matcher, *task, wanted.episodes)?;
        self.locomotion.report(policy, &trained, wanted)
    }

    fn milestones(&self) -> &'static [u64] {
        &MILESTONES
    }

    #[cfg(feature = "report")]
    fn figures(&self, run: &RunDir, rows: &[UpdateMetrics]) -> Result<Vec<PathBuf>> {
        figures::plane::draw(run, rows, &MILESTONES, &self.locomotion)
    }

    fn locomotion(&self) -> Option<&Locomotion> {
        Some(&self.locomotion)
    }
}
