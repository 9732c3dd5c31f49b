//! The task `box`: two simulated bodies learn to fight each other, by self-play.

use super::motion_training::{MotionTask, load, with_recordings};
use super::motions::Performance;
use super::presets::{discriminator, steering, styled};
use crate::env::EnvSpec;
use crate::env::humanoid::boxing::evaluate::{BoxingReport, evaluate};
use crate::env::humanoid::boxing::{Boxing, BoxingTask, boxing_spec};
use crate::env::humanoid::driver::BodyDriver;
use crate::physics::motion_library::MotionLibrary;
use crate::physics::scenes;
use crate::rl::amp::Amp;
use crate::rl::ase::STEPS_PER_DECISION;
use crate::rl::ppo::Ppo;
use crate::rl::self_play::SelfPlay;
use crate::train::config::{Config, ConfigError, Preset, TaskPreset, settings, table};
use crate::train::evaluation::Evaluation;
use crate::train::low_level;
use crate::train::task::{Ablation, Measure, Steering, TaskEntry, Variant};
use std::sync::Arc;

/// The task `box` in the registry.
pub const ENTRY: TaskEntry = TaskEntry {
    name: "box",
    about: "Let two simulated bodies learn to fight each other, by self-play",
    preset,
    steering: Some(Steering {
        preset: steering_preset,
        measures: MEASURES,
        rates: RATES,
    }),
    spec: check,
    takes_motions: true,
    load: |config| load::<BoxTask>(config, scenes::humanoid()),
    with_recordings: Some(with_recordings::<BoxTask>),
    ablations: &[ABLATION],
};

/// What is compared of bouts.
const MEASURES: &[Measure] = &[
    Measure::percent("engaged %", "engagement"),
    Measure {
        title: "knock-downs a bout",
        name: "knockdowns_per_bout",
        unit: 1.0,
        digits: 2,
    },
    Measure::percent("from behind %", "from_behind"),
];
const RATES: &[&str] = &["win_rate", "engagement", "knockdowns"];

/// The paper's figure 9.
const ABLATION: Ablation = Ablation {
    name: "box",
    about: "Boxing: with and without the rewards for facing each other",
    folder: "runs/box-ablation",
    measures: MEASURES,
    rates: RATES,
    variants: &[
        Variant {
            name: "full",
            changes: toml::Table::new,
        },
        Variant {
            name: "no-facing",
            changes: || toml::toml! { facing = false },
        },
    ],
};

fn preset(chosen: Preset) -> TaskPreset {
    TaskPreset {
        settings: table(&match chosen {
            Preset::Fast => Boxing::default(),
            Preset::Paper => Boxing::printed(),
        }),
        ppo: Ppo {
            gamma: 0.99,
            ..styled(chosen)
        },
        amp: Some(Amp {
            style_weight: 0.5,
            task_weight: 0.5,
            ..discriminator(chosen)
        }),
        ase: None,
        self_play: Some(SelfPlay::default()),
        steps: 20_000_000,
    }
}

fn steering_preset(chosen: Preset) -> TaskPreset {
    TaskPreset {
        ppo: steering(chosen),
        amp: None,
        steps: 5_000_000,
        ..preset(chosen)
    }
}

fn check(config: &Config) -> Result<EnvSpec, ConfigError> {
    let task = BoxTask::of(config)?;
    task.boxing.check().map_err(ConfigError::Settings)?;
    // The learner plays one of the two fighters.
    Ok(EnvSpec {
        agents: 1,
        ..low_level::steered(config, boxing_spec(config.ppo.envs))?
    })
}

#[derive(Clone)]
struct BoxTask {
    boxing: Boxing,
    self_play: SelfPlay,
}

impl MotionTask for BoxTask {
    type Played = BoxingTask;
    type Report = BoxingReport;

    const PERFORMANCE: Performance = Performance::Boxing;
    /// A bout may last for most of a minute, and is of two bodies.
    const MOST_EPISODES: usize = 200;
    const STEP_FRACTIONS: &'static [(&'static str, &'static str)] =
        &[("engagement", "engaged_steps")];

    fn of(config: &Config) -> Result<Self, ConfigError> {
        Ok(BoxTask {
            boxing: settings(&config.task.settings)?,
            self_play: config.self_play.unwrap_or_default(),
        })
    }

    fn settings(&self) -> toml::Table {
        table(&self.boxing)
    }

    fn notes(&self, config: &Config) -> Vec<String> {
        // Of a step: a decision's discount is that of all its steps.
        let gamma = match &config.skills {
            Some(_) => config.ppo.gamma.powf(1.0 / STEPS_PER_DECISION as f32),
            None => config.ppo.gamma,
        };
        let ratio = self.boxing.bonus_ratio(gamma);
        vec![format!(
            "a knock-down is worth {ratio:.2} bouts of standing close and face to face"
        )]
    }

    fn played(&self, library: &Arc<MotionLibrary>, seed: u32) -> Arc<BoxingTask> {
        Arc::new(BoxingTask::new(&self.boxing, library, seed))
    }

    fn self_play(&self) -> Option<&SelfPlay> {
        Some(&self.self_play)
    }

    fn bouts(task: Arc<BoxingTask>) -> Option<Arc<BoxingTask>> {
        Some(task)
    }

    fn evaluate(
        task: Arc<BoxingTask>,
        _: &MotionLibrary,
        drivers: [&dyn BodyDriver; 2],
        episodes: usize,
        seed: u32,
    ) -> BoxingReport {
        evaluate(task, drivers, episodes, seed)
    }

    fn evaluation(found: &BoxingReport) -> Evaluation {
        let measures = [
            ("lost", found.lost),
            ("mean_bout_s", found.mean_bout_s),
            ("engagement", found.engagement),
            ("knockdowns_per_bout", found.knockdowns[0]),
            ("damage", found.damage[0]),
            ("from_behind", found.from_behind),
            ("clinches_per_bout", found.clinches_per_bout),
        ];
        Evaluation {
            episodes: found.bouts,
            success: found.won,
            success_name: "won",
            measures: measures.into(),
        }
    }

    fn sentence(&self, found: &Evaluation) -> String {
        format!(
            "{:.1} % of {} bouts won against one whom nobody has trained, {:.1} % lost; {:.2} knock-downs a bout",
            100.0 * found.success,
            found.episodes,
            100.0 * found.measure("lost"),
            found.measure("knockdowns_per_bout"),
        )
    }

    fn details(found: &BoxingReport) -> String {
        format!(
            "engaged for {:.0} % of the time, {:.1} s a bout; {:.0} N s of punches a bout, {:.0} % from behind; {:.2} \
             clinches; out of the arena in {:.1} % of the bouts\n",
            100.0 * found.engagement,
            found.mean_bout_s,
            found.damage[0],
            100.0 * found.from_behind,
            found.clinches_per_bout,
            100.0 * found.out[0],
        )
    }
}
