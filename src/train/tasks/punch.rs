//! The tasks `punch` and `joystick`: a simulated body goes up to a box and topples it, in the style of
//! recordings.

use super::imitate::ppo;
use super::motions::{self, Performance};
use crate::env::humanoid::punch::evaluate::{PunchReport, evaluate};
use crate::env::humanoid::punch::{Punch, PunchTask};
use crate::env::humanoid::task::{open, spec};
use crate::env::{EnvBatch, EnvSpec};
use crate::gpu::Device;
use crate::kernels::humanoid::punch_observe;
use crate::nn::Policy;
use crate::physics::motion_library::MotionLibrary;
use crate::physics::scenes;
use crate::rl::Algorithm;
use crate::rl::amp::Amp;
use crate::rl::ppo::Ppo;
use crate::train::body_episodes::{BodyEpisodes, EPISODES_SEED};
use crate::train::config::{Config, ConfigError, Preset, TaskPreset, settings, table};
use crate::train::evaluation::{EvalOptions, EvalReport, Evaluation};
use crate::train::task::{Ablation, Loaded, Measure, Task, TaskEntry, Variant};
#[cfg(feature = "report")]
use crate::train::{figures, metrics::UpdateMetrics, run_dir::RunDir};
use anyhow::Result;
use std::sync::Arc;

/// The task `punch` in the registry.
pub const PUNCH: TaskEntry = TaskEntry {
    name: "punch",
    about: "Let a simulated body run up to a box and topple it",
    preset,
    spec: check,
    load,
    ablations: &[ABLATION],
};

/// The paper's figure 3, and the forms of the reward for a far target.
const ABLATION: Ablation = Ablation {
    name: "punch",
    about: "The punching task: with and without its facing reward, and other rewards for a far target",
    folder: "runs/punch-ablation",
    measures: &[
        Measure::percent("by a fist %", "fist_rate"),
        Measure::percent("survival %", "survival"),
        Measure::seconds("time s", "time_to_hit_mean_s"),
        Measure {
            title: "facing error deg",
            name: "facing_error_deg",
            unit: 1.0,
            digits: 1,
        },
    ],
    rates: &["hit", "fall"],
    variants: &[
        Variant {
            name: "full",
            changes: toml::Table::new,
        },
        Variant {
            name: "no-facing",
            changes: || toml::toml! { facing = false },
        },
        Variant {
            name: "slow-product",
            changes: || toml::toml! { far = "slow" },
        },
        Variant {
            name: "printed-product",
            changes: || toml::toml! { far = "printed" },
        },
    ],
};

/// The task `joystick` in the registry.
pub const JOYSTICK: TaskEntry = TaskEntry {
    name: "joystick",
    about: "The same, while it faces any way that is wanted",
    ablations: &[],
    ..PUNCH
};

fn preset(_: Preset) -> TaskPreset {
    TaskPreset {
        settings: table(&Punch::default()),
        ppo: Ppo {
            // With less, most falls are slow tips out of the guard.
            gamma: 0.99,
            ..ppo()
        },
        amp: Some(Amp {
            style_weight: 0.5,
            task_weight: 0.5,
            ..Amp::default()
        }),
        steps: 10_000_000,
    }
}

fn is_joystick(config: &Config) -> bool {
    config.task.name == JOYSTICK.name
}

fn check(config: &Config) -> Result<EnvSpec, ConfigError> {
    let punch: Punch = settings(&config.task.settings)?;
    punch.check().map_err(ConfigError::Settings)?;
    let added = punch_observe::dim(is_joystick(config));
    Ok(spec(&scenes::humanoid_and_box(), added, config.ppo.envs))
}

fn load(config: &Config) -> Result<Loaded> {
    let model = Arc::new(scenes::humanoid());
    let (library, notes) = motions::load(config, &model, Performance::Boxing)?;
    let task = PunchTraining {
        punch: settings(&config.task.settings)?,
        joystick: is_joystick(config),
        library: Arc::new(library),
    };
    Ok(Loaded {
        task: Box::new(task),
        notes,
    })
}

/// A report as the trainer knows it.
fn evaluation(found: &PunchReport) -> Evaluation {
    let measures = [
        ("episode_length_mean_s", found.mean_episode_s),
        ("survival", found.survival),
        ("fist_rate", found.fist_rate),
        ("time_to_hit_mean_s", found.time_to_hit_mean_s),
        ("facing_error_deg", found.facing_error_deg),
    ];
    Evaluation {
        episodes: found.episodes,
        success: found.hit_rate,
        measures: measures.into_iter().collect(),
    }
}

struct PunchTraining {
    punch: Punch,
    joystick: bool,
    library: Arc<MotionLibrary>,
}

impl PunchTraining {
    fn task(&self, punch: &Punch, seed: u32) -> Arc<PunchTask> {
        Arc::new(PunchTask::new(punch, self.joystick, &self.library, seed))
    }

    fn rate(&self, policy: &Policy, episodes: usize) -> PunchReport {
        let mean = |observation: &[f32]| policy.mean(observation);
        let task = self.task(&self.punch.evaluated(), EPISODES_SEED);
        evaluate(task, &mean, episodes, EPISODES_SEED)
    }
}

impl Task for PunchTraining {
    fn settings(&self) -> toml::Table {
        table(&self.punch)
    }

    fn with_choices(&self, config: &Config) -> Result<Box<dyn Task>, ConfigError> {
        Ok(Box::new(PunchTraining {
            punch: settings(&config.task.settings)?,
            joystick: self.joystick,
            library: self.library.clone(),
        }))
    }

    fn fingerprint(&self) -> u32 {
        motions::fingerprint(&self.library)
    }

    fn describe(&self) -> String {
        motions::describe(&self.library)
    }

    fn open(&self, device: &Device, envs: usize, seed: u32) -> Result<EnvBatch> {
        let task = self.task(&self.punch, seed);
        EnvBatch::open(device, envs, None, |part| {
            open(device, task.clone(), part, seed)
        })
    }

    fn learner(
        &self,
        config: &Config,
        envs: &EnvBatch,
        device: &Device,
    ) -> Result<Box<dyn Algorithm>> {
        motions::learner(config, &self.library, envs, device)
    }

    fn evaluate(&self, policy: &Policy, episodes: usize) -> Result<Evaluation> {
        Ok(evaluation(&self.rate(policy, episodes)))
    }

    fn sentence(&self, found: &Evaluation) -> String {
        format!(
            "{:.1} % of {} targets toppled, {:.1} s on average; {:.1} % by a fist, {:.1} % of the episodes without a \
             fall",
            100.0 * found.success,
            found.episodes,
            found.measure("time_to_hit_mean_s"),
            100.0 * found.measure("fist_rate"),
            100.0 * found.measure("survival"),
        )
    }

    fn report(&self, policy: &Policy, wanted: &EvalOptions) -> Result<EvalReport> {
        motions::refuse_matching(wanted)?;
        let found = self.rate(policy, wanted.episodes);
        let evaluation = evaluation(&found);
        Ok(EvalReport {
            text: format!(
                "{}\nfacing error {:.0} degrees while the target is far\n",
                self.sentence(&evaluation),
                found.facing_error_deg
            ),
            json: serde_json::to_value(found)?,
        })
    }

    #[cfg(feature = "report")]
    fn figures(&self, run: &RunDir, rows: &[UpdateMetrics]) -> Result<()> {
        figures::draw_curve(run, rows)
    }

    fn body(&self) -> Option<BodyEpisodes> {
        let (punch, joystick) = (self.punch.evaluated(), self.joystick);
        let library = self.library.clone();
        let task = move |seed| PunchTask::new(&punch, joystick, &library, seed);
        Some(BodyEpisodes::new(task, Some(&self.library)))
    }
}
