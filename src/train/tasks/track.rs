//! The task `track`: a simulated body follows recordings moment by moment.

use super::imitate::fidelity_measures;
use super::motion_training::{MotionTask, load, with_recordings};
use super::motions::Performance;
use super::presets::styled;
use crate::env::EnvSpec;
use crate::env::humanoid::driver::BodyDriver;
use crate::env::humanoid::task::spec;
use crate::env::humanoid::track::{TrackReport, TrackTask, Tracking, evaluate};
use crate::kernels::humanoid::track_observe;
use crate::physics::motion_library::MotionLibrary;
use crate::physics::scenes;
use crate::train::config::{Config, ConfigError, Preset, TaskPreset, settings, table};
use crate::train::evaluation::Evaluation;
use crate::train::task::TaskEntry;
use std::sync::Arc;

/// The task in the registry.
pub const ENTRY: TaskEntry = TaskEntry {
    name: "track",
    about: "Let a simulated body follow recordings moment by moment",
    preset,
    steering: None,
    spec: check,
    takes_motions: true,
    load: |config| load::<Tracking>(config, scenes::humanoid()),
    with_recordings: Some(with_recordings::<Tracking>),
    ablations: &[],
};

fn preset(preset: Preset) -> TaskPreset {
    TaskPreset {
        settings: table(&Tracking::default()),
        ppo: styled(preset),
        amp: None,
        ase: None,
        self_play: None,
        steps: 2_500_000,
    }
}

fn check(config: &Config) -> Result<EnvSpec, ConfigError> {
    let track = Tracking::of(config)?;
    track.check().map_err(ConfigError::Settings)?;
    let model = scenes::humanoid();
    Ok(spec(&model, track_observe::dim(&model), config.ppo.envs))
}

impl MotionTask for Tracking {
    type Played = TrackTask;
    type Report = TrackReport;

    const PERFORMANCE: Performance = Performance::Walk;

    fn of(config: &Config) -> Result<Self, ConfigError> {
        settings(&config.task.settings)
    }

    fn settings(&self) -> toml::Table {
        table(self)
    }

    fn played(&self, library: &Arc<MotionLibrary>, seed: u32) -> Arc<TrackTask> {
        Arc::new(TrackTask::new(self, library, seed))
    }

    fn evaluate(
        task: Arc<TrackTask>,
        _library: &MotionLibrary,
        [driver, _]: [&dyn BodyDriver; 2],
        episodes: usize,
        seed: u32,
    ) -> TrackReport {
        evaluate(task, driver, episodes, seed)
    }

    fn evaluation(found: &TrackReport) -> Evaluation {
        let own = [
            ("root_error_m", found.root_error_m),
            ("key_error_m", found.key_error_m),
        ];
        let measures = fidelity_measures(&found.fidelity).into_iter().chain(own);
        Evaluation {
            episodes: found.fidelity.episodes,
            success: found.fidelity.survival,
            success_name: "survival",
            measures: measures.collect(),
        }
    }

    fn sentence(&self, found: &Evaluation) -> String {
        format!(
            "{:.1} % of {} episodes keep up with the recordings, hands and feet {:.3} m from where they should be",
            100.0 * found.success,
            found.episodes,
            found.measure("key_error_m"),
        )
    }

    fn details(found: &TrackReport) -> String {
        format!(
            "episode {:.2} s on average, root {:.3} m from where it should be\n",
            found.fidelity.mean_episode_s, found.root_error_m,
        )
    }
}
