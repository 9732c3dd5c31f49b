//! The task `imitate`: a simulated body moves like recordings, which a discriminator judges.

use super::motion_training::{MotionTask, load, with_recordings};
use super::motions::Performance;
use super::presets::{discriminator, styled};
use crate::env::EnvSpec;
use crate::env::humanoid::driver::BodyDriver;
use crate::env::humanoid::fidelity::FidelityReport;
use crate::env::humanoid::imitate::{ImitateTask, evaluate};
use crate::env::humanoid::task::{EpisodeRules, spec};
use crate::physics::motion_library::MotionLibrary;
use crate::physics::scenes;
use crate::train::config::{Config, ConfigError, Preset, TaskPreset, settings, table};
use crate::train::evaluation::Evaluation;
use crate::train::task::TaskEntry;
use std::sync::Arc;

/// The task in the registry.
pub const ENTRY: TaskEntry = TaskEntry {
    name: "imitate",
    about: "Move a simulated body like recordings",
    preset,
    steering: None,
    spec: check,
    takes_motions: true,
    load: |config| load::<Imitate>(config, scenes::humanoid()),
    with_recordings: Some(with_recordings::<Imitate>),
    ablations: &[],
};

fn preset(preset: Preset) -> TaskPreset {
    TaskPreset {
        settings: table(&EpisodeRules::default()),
        ppo: styled(preset),
        amp: Some(discriminator(preset)),
        ase: None,
        self_play: None,
        steps: 2_500_000,
    }
}

fn check(config: &Config) -> Result<EnvSpec, ConfigError> {
    let imitate = Imitate::of(config)?;
    imitate.rules.check().map_err(ConfigError::Settings)?;
    Ok(spec(&scenes::humanoid(), 0, config.ppo.envs))
}

/// What all tasks measure of motion.
pub fn fidelity_measures(found: &FidelityReport) -> [(&'static str, f64); 5] {
    [
        ("episode_length_mean_s", found.mean_episode_s),
        ("speed_ratio", found.speed_ratio),
        ("dtw_m", found.dtw_m),
        ("coverage", found.coverage),
        ("power_w", found.power_w),
    ]
}

#[derive(Clone)]
struct Imitate {
    rules: EpisodeRules,
}

impl MotionTask for Imitate {
    type Played = ImitateTask;
    type Report = FidelityReport;

    const PERFORMANCE: Performance = Performance::Walk;

    fn of(config: &Config) -> Result<Self, ConfigError> {
        let rules = settings(&config.task.settings)?;
        Ok(Imitate { rules })
    }

    fn settings(&self) -> toml::Table {
        table(&self.rules)
    }

    fn played(&self, library: &Arc<MotionLibrary>, seed: u32) -> Arc<ImitateTask> {
        Arc::new(ImitateTask::new(&self.rules, library, seed))
    }

    fn evaluate(
        task: Arc<ImitateTask>,
        _library: &MotionLibrary,
        [driver, _]: [&dyn BodyDriver; 2],
        episodes: usize,
        seed: u32,
    ) -> FidelityReport {
        evaluate(task, driver, episodes, seed)
    }

    fn evaluation(found: &FidelityReport) -> Evaluation {
        Evaluation {
            episodes: found.episodes,
            success: found.survival,
            success_name: "survival",
            measures: fidelity_measures(found).into_iter().collect(),
        }
    }

    fn sentence(&self, found: &Evaluation) -> String {
        format!(
            "{:.1} % of {} episodes stay up for {} s, at {:.2} of the recordings' speed, {:.3} m from them",
            100.0 * found.success,
            found.episodes,
            self.rules.episode_s,
            found.measure("speed_ratio"),
            found.measure("dtw_m"),
        )
    }

    fn details(found: &FidelityReport) -> String {
        format!(
            "episode {:.2} s on average, coverage of the clips {:.0} %\n",
            found.mean_episode_s,
            100.0 * found.coverage,
        )
    }
}
