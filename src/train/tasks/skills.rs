//! The task `skills`: a simulated body moves like recordings, differently under every latent.

use super::imitate::fidelity_measures;
use super::motion_training::{MotionTask, load, with_recordings};
use super::motions::Performance;
use super::presets::{discriminator, styled};
use crate::env::EnvSpec;
use crate::env::humanoid::driver::BodyDriver;
use crate::env::humanoid::imitate::ImitateTask;
use crate::env::humanoid::skills::{SkillReport, evaluate};
use crate::env::humanoid::task::{EpisodeRules, spec};
use crate::physics::motion_library::MotionLibrary;
use crate::physics::scenes;
use crate::rl::amp::{Amp, SkillRewards};
use crate::rl::ase::{Ase, LatentDraw};
use crate::train::config::{Config, ConfigError, Preset, TaskPreset, settings, table};
use crate::train::evaluation::Evaluation;
use crate::train::task::TaskEntry;
use std::sync::Arc;

/// The task in the registry.
pub const ENTRY: TaskEntry = TaskEntry {
    name: "skills",
    about: "Teach a simulated body many skills, chosen by a latent",
    preset,
    steering: None,
    spec: check,
    takes_motions: true,
    load: |config| load::<Skills>(config, scenes::humanoid()),
    with_recordings: Some(with_recordings::<Skills>),
    ablations: &[],
};

fn preset(preset: Preset) -> TaskPreset {
    let latent = match preset {
        Preset::Fast => Ase::default().latent,
        Preset::Paper => 64,
    };
    TaskPreset {
        settings: table(&EpisodeRules::default()),
        ppo: styled(preset),
        amp: Some(Amp {
            style_weight: 0.5,
            ..discriminator(preset)
        }),
        ase: Some(Ase {
            latent,
            ..Ase::default()
        }),
        self_play: None,
        steps: 20_000_000,
    }
}

fn check(config: &Config) -> Result<EnvSpec, ConfigError> {
    let skills = Skills::of(config)?;
    skills.rules.check().map_err(ConfigError::Settings)?;
    let body = spec(&scenes::humanoid(), 0, config.ppo.envs);
    let mut observation = body.observation;
    observation.vector += skills.ase.latent;
    Ok(EnvSpec {
        observation,
        ..body
    })
}

#[derive(Clone)]
struct Skills {
    rules: EpisodeRules,
    ase: Ase,
}

impl MotionTask for Skills {
    type Played = ImitateTask;
    type Report = SkillReport;

    const PERFORMANCE: Performance = Performance::Boxing;

    fn of(config: &Config) -> Result<Self, ConfigError> {
        Ok(Skills {
            rules: settings(&config.task.settings)?,
            ase: config.ase.clone().unwrap_or_default(),
        })
    }

    fn settings(&self) -> toml::Table {
        table(&self.rules)
    }

    fn played(&self, library: &Arc<MotionLibrary>, seed: u32) -> Arc<ImitateTask> {
        Arc::new(ImitateTask::new(&self.rules, library, seed))
    }

    fn latents(&self, library: &MotionLibrary) -> Option<LatentDraw> {
        let clips = 0..library.motions().len();
        let shares: Vec<f32> = clips.map(|clip| library.share(clip)).collect();
        Some(LatentDraw::new(&self.ase, &shares))
    }

    fn skill_rewards(&self) -> SkillRewards {
        self.ase.rewards()
    }

    fn evaluate(
        task: Arc<ImitateTask>,
        library: &MotionLibrary,
        [driver, _]: [&dyn BodyDriver; 2],
        episodes: usize,
        seed: u32,
    ) -> SkillReport {
        evaluate(task, library, driver, episodes, seed)
    }

    fn evaluation(found: &SkillReport) -> Evaluation {
        let own = [
            ("coverage_entropy", found.fidelity.coverage_entropy),
            ("survival_changing", found.survival_changing),
            ("repeatability", found.repeatability),
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
            "{:.1} % of {} episodes stay up for {} s under changing latents; {:.0} % of the clips covered, the same \
             clip under the same latent in {:.0} % of the time",
            100.0 * found.success,
            found.episodes,
            self.rules.episode_s,
            100.0 * found.measure("coverage"),
            100.0 * found.measure("repeatability"),
        )
    }

    fn details(found: &SkillReport) -> String {
        format!(
            "{:.1} % stay up under latents that change every second; episode {:.2} s on average, {:.3} m from the \
             recordings; entropy of the clips {:.2} of the largest\n",
            100.0 * found.survival_changing,
            found.fidelity.mean_episode_s,
            found.fidelity.dtw_m,
            found.fidelity.coverage_entropy,
        )
    }
}
