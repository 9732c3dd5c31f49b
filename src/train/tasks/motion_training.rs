//! What the tasks of a simulated body with recordings share: [`MotionTraining`] is a [`Task`] of any
//! [`MotionTask`].

use super::motions;
use crate::env::humanoid::boxing::BoxingTask;
use crate::env::humanoid::driver::{BodyDriver, RepeatAction};
use crate::env::humanoid::task::{HumanoidTask, open, spec};
use crate::env::{EnvBatch, VecEnv};
use crate::gpu::Device;
use crate::nn::Policy;
use crate::physics::model::Model;
use crate::physics::motion_library::MotionLibrary;
use crate::ranks::Ranks;
use crate::rl::Algorithm;
use crate::rl::amp::SkillRewards;
use crate::rl::ase::{
    FrozenLowLevel, HighLevelDriver, HighLevelEnv, LatentDraw, LatentDriver, LatentEnv, Script,
    ScriptedDriver,
};
use crate::rl::self_play::{Opponent, SelfPlay, SelfPlayEnv, SelfPlayLearner};
use crate::train::anchors;
use crate::train::body_episodes::{BodyEpisodes, EPISODES_SEED};
use crate::train::config::{Config, ConfigError};
use crate::train::evaluation::{EvalOptions, EvalReport, Evaluation};
use crate::train::fingerprint::Fingerprint;
use crate::train::low_level;
use crate::train::task::{Loaded, Task, ppo_learner};
use crate::train::tournament::{Bouts, TournamentPlayer};
use anyhow::Result;
use serde::Serialize;
use std::sync::Arc;

/// What a task of a simulated body with recordings decides for itself. Its value holds the choices.
pub trait MotionTask: Clone + Send + Sync + 'static {
    /// What its environments play.
    type Played: HumanoidTask + 'static;
    /// What an evaluation finds.
    type Report: Serialize;

    /// What the performer does where no recordings are given.
    const PERFORMANCE: motions::Performance;
    /// Most episodes of an evaluation in a training.
    const MOST_EPISODES: usize = usize::MAX;
    /// Names of metrics that are fractions of the episodes' steps, and of the statistics that count these steps.
    const STEP_FRACTIONS: &'static [(&'static str, &'static str)] = &[];

    /// The choices of a configuration.
    ///
    /// # Errors
    /// An unknown or a wrong one.
    fn of(config: &Config) -> Result<Self, ConfigError>;

    /// The choices as the table `[task]`, but for the name.
    fn settings(&self) -> toml::Table;

    /// What the user should know of the choices of a training.
    fn notes(&self, _config: &Config) -> Vec<String> {
        Vec::new()
    }

    /// The task in a training; its start states depend on `seed`.
    fn played(&self, library: &Arc<MotionLibrary>, seed: u32) -> Arc<Self::Played>;

    /// The task in an evaluation.
    fn judged(&self, library: &Arc<MotionLibrary>, seed: u32) -> Arc<Self::Played> {
        self.played(library, seed)
    }

    /// The latents under which agents move, if there are any.
    fn latents(&self, _library: &MotionLibrary) -> Option<LatentDraw> {
        None
    }

    /// What makes them move differently under different latents.
    fn skill_rewards(&self) -> SkillRewards {
        SkillRewards::default()
    }

    /// How it is learned by self-play, if it is: its environments are then of two agents.
    fn self_play(&self) -> Option<&SelfPlay> {
        None
    }

    /// What two policies fight in, if they do.
    fn bouts(_: Arc<Self::Played>) -> Option<Arc<BoxingTask>> {
        None
    }

    /// Plays `episodes` episodes, whose starts depend on `seed` alone, under the policy's driver; in bouts against the
    /// other one, the least active of those whom nobody has trained.
    fn evaluate(
        task: Arc<Self::Played>,
        library: &MotionLibrary,
        drivers: [&dyn BodyDriver; 2],
        episodes: usize,
        seed: u32,
    ) -> Self::Report;

    /// A report as the trainer knows it.
    fn evaluation(report: &Self::Report) -> Evaluation;

    /// An evaluation in a sentence without its full stop.
    fn sentence(&self, found: &Evaluation) -> String;

    /// What else `footwork eval` tells, in lines.
    fn details(report: &Self::Report) -> String;
}

/// A task with its choices made and its recordings loaded.
pub struct MotionTraining<T> {
    task: T,
    library: Arc<MotionLibrary>,
    /// What its policy steers, if it does not act itself.
    low_level: Option<Arc<FrozenLowLevel>>,
}

/// Loads the recordings of a task, and the low level, if one is steered.
///
/// # Errors
/// A wrong choice; a low level that cannot be read; recordings that are missing or damaged, or of nobody that the
/// body could move like.
pub fn load<T: MotionTask>(config: &Config, body: Model) -> Result<Loaded> {
    let task = T::of(config)?;
    let (library, mut notes) = motions::load(config, &Arc::new(body), T::PERFORMANCE)?;
    notes.extend(task.notes(config));
    let low_level = config.skills.as_deref().map(low_level::load).transpose()?;
    Ok(Loaded {
        task: Box::new(MotionTraining {
            task,
            library: Arc::new(library),
            low_level: low_level.map(Arc::new),
        }),
        notes,
    })
}

/// A task of recordings that are loaded already.
///
/// # Errors
/// A wrong choice.
pub fn with_recordings<T: MotionTask>(
    config: &Config,
    library: MotionLibrary,
) -> Result<Box<dyn Task>> {
    Ok(Box::new(MotionTraining {
        task: T::of(config)?,
        library: Arc::new(library),
        low_level: None,
    }))
}

impl<T: MotionTask> MotionTraining<T> {
    fn rate(&self, policy: &Policy, episodes: usize) -> T::Report {
        let task = self.task.judged(&self.library, EPISODES_SEED);
        let driver = self.driver(policy);
        let fights = T::bouts(task.clone()).is_some();
        let anchors = if fights {
            self.anchors(&*task)
        } else {
            Vec::new()
        };
        let opponent = anchors.first().map_or(&*driver, |anchor| &*anchor.driver);
        let drivers = [&*driver, opponent];
        T::evaluate(task, &self.library, drivers, episodes, EPISODES_SEED)
    }

    /// What there is to do over a low level by a script, the least first.
    fn scripts(&self, low_level: &FrozenLowLevel) -> Vec<(&'static str, Script)> {
        let library = &self.library;
        let clips = 0..library.motions().len();
        let shares: Vec<f32> = clips.map(|clip| library.share(clip)).collect();
        match low_level.latents(motions::fingerprint(library), &shares) {
            Some(draw) => anchors::scripts(&draw, library, low_level.widths()[0]),
            // Which clip of its own it moves like under which latent is not known here.
            None => vec![anchors::unsteered(low_level.latent())],
        }
    }

    /// Those whom nobody has trained, the least active first.
    fn anchors(&self, task: &dyn HumanoidTask) -> Vec<TournamentPlayer> {
        let observation = spec(task.model(), task.observation(), 1).observation.dim();
        let player = |name: &str, driver: Box<dyn BodyDriver>| TournamentPlayer {
            name: name.into(),
            driver,
        };
        let Some(low_level) = &self.low_level else {
            let still = RepeatAction::new(task.rest_action(), observation);
            return vec![player("(does nothing)", Box::new(still))];
        };
        let scripts = self.scripts(low_level).into_iter();
        let driver = |script| Box::new(ScriptedDriver::new(low_level, script, observation));
        scripts
            .map(|(name, script)| player(name, driver(script)))
            .collect()
    }

    /// The opponents whom nobody has trained.
    fn scripted_opponents(&self, envs: &EnvBatch) -> Vec<Opponent> {
        let Some(low_level) = &self.low_level else {
            return vec![Opponent::repeating(envs.rest_action())];
        };
        let scripts = self.scripts(low_level).into_iter();
        let opponent = |(_, script)| match script {
            Script::Strides(strides) => Some(Opponent::Scripted(strides)),
            // Latents that change at random are the untrained policy's.
            Script::Random(..) => None,
        };
        scripts.filter_map(opponent).collect()
    }
}

impl<T: MotionTask> Task for MotionTraining<T> {
    fn settings(&self) -> toml::Table {
        self.task.settings()
    }

    fn with_choices(&self, config: &Config) -> Result<Box<dyn Task>, ConfigError> {
        Ok(Box::new(MotionTraining {
            task: T::of(config)?,
            library: self.library.clone(),
            low_level: self.low_level.clone(),
        }))
    }

    fn fingerprint(&self) -> Fingerprint {
        let low_level = self.low_level();
        Fingerprint {
            data: motions::fingerprint(&self.library),
            low_level: low_level.map_or(0, FrozenLowLevel::fingerprint),
        }
    }

    fn describe(&self) -> String {
        let motions = motions::describe(&self.library);
        match &self.low_level {
            None => motions,
            Some(low_level) => format!("{motions}, skills of {} numbers", low_level.latent()),
        }
    }

    fn open(&self, device: &Device, ranks: &Ranks, envs: usize, seed: u32) -> Result<EnvBatch> {
        let task = self.task.played(&self.library, seed);
        let latents = self.task.latents(&self.library);
        EnvBatch::open(device, ranks, envs, None, |part| {
            let first = part.start;
            let body = open(device, task.clone(), part, seed)?;
            let acting: Box<dyn VecEnv> = match (&self.low_level, &latents) {
                (Some(low_level), _) => Box::new(HighLevelEnv::new(body, low_level, device)?),
                (None, Some(draw)) => Box::new(LatentEnv::new(body, draw, device, first, seed)),
                (None, None) => body,
            };
            Ok(match self.task.self_play() {
                Some(_) => Box::new(SelfPlayEnv::new(acting, device, first, seed)?),
                None => acting,
            })
        })
    }

    fn learner(
        &self,
        config: &Config,
        envs: &EnvBatch,
        device: &Device,
    ) -> Result<Box<dyn Algorithm>> {
        let learner = match (&self.low_level, &config.amp) {
            (Some(_), _) => motions::steering_learner(config, envs, device)?,
            (None, Some(amp)) => {
                let (skills, latents) =
                    (self.task.skill_rewards(), self.task.latents(&self.library));
                let latents = latents.as_ref();
                motions::learner(config, amp, &skills, latents, &self.library, envs, device)?
            }
            (None, None) => ppo_learner(config, envs, device)?,
        };
        let Some(self_play) = self.task.self_play() else {
            return Ok(learner);
        };
        let (steps, fractions) = (config.ppo.rollout_length, T::STEP_FRACTIONS);
        let scripted = self.scripted_opponents(envs);
        let learner = SelfPlayLearner::new(learner, self_play, envs, scripted, steps, fractions)?;
        Ok(Box::new(learner))
    }

    fn driver(&self, policy: &Policy) -> Box<dyn BodyDriver> {
        match (&self.low_level, self.task.latents(&self.library)) {
            (Some(low_level), _) => Box::new(HighLevelDriver {
                policy: policy.clone(),
                low_level: low_level.clone(),
            }),
            (None, Some(draw)) => Box::new(LatentDriver::new(policy, &draw, EPISODES_SEED)),
            (None, None) => Box::new(policy.clone()),
        }
    }

    fn low_level(&self) -> Option<&FrozenLowLevel> {
        self.low_level.as_deref()
    }

    fn evaluate(&self, policy: &Policy, episodes: usize) -> Result<Evaluation> {
        let episodes = episodes.min(T::MOST_EPISODES);
        Ok(T::evaluation(&self.rate(policy, episodes)))
    }

    fn sentence(&self, found: &Evaluation) -> String {
        self.task.sentence(found)
    }

    fn report(&self, policy: &Policy, wanted: &EvalOptions) -> Result<EvalReport> {
        motions::refuse_matching(wanted)?;
        let found = self.rate(policy, wanted.episodes);
        let sentence = self.task.sentence(&T::evaluation(&found));
        Ok(EvalReport {
            text: format!("{sentence}\n{}", T::details(&found)),
            json: serde_json::to_value(found)?,
        })
    }

    fn bouts(&self) -> Option<Bouts> {
        let task = T::bouts(self.task.judged(&self.library, EPISODES_SEED))?;
        let anchors = self.anchors(&*task);
        Some(Bouts { task, anchors })
    }

    fn body(&self) -> Option<BodyEpisodes> {
        let (task, library) = (self.task.clone(), self.library.clone());
        let judged = move |seed| task.judged(&library, seed);
        let bouts = T::bouts(self.task.judged(&self.library, EPISODES_SEED));
        let episodes = BodyEpisodes::new(judged, Some(&self.library)).with_bouts(bouts);
        Some(episodes.with_latents(self.task.latents(&self.library)))
    }
}
