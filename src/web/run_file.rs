//! What a page needs of a run, but for the parts of its motion: a file.

use super::motion_parts::{MotionHeader, put_columns, take_columns};
use super::quantise::QuantisedColumns;
use crate::container::{Format, Section, SectionError, Sections, StoreError};
use crate::env::ObservationSpec;
use crate::env::locomotion::LocomotionTask;
use crate::nn::network::NetworkConfig;
use crate::nn::{Policy, RunningMeanStd};
use crate::physics::model::Model;
use crate::physics::motion_clip::MotionClip;
use crate::physics::motion_library::MotionLibrary;
use crate::train::config::Config;
use anyhow::{Context, Result};
use std::path::Path;
use std::sync::Arc;

/// Name of the file, in error messages too.
pub const NAME: &str = "run.footwork";

const FORMAT: Format = Format {
    kind: "web",
    version: 1,
};

/// What is played.
pub enum Played {
    /// Motion matching, whose motion comes in parts.
    Locomotion {
        /// The task with its choices.
        task: LocomotionTask,
        /// What is known of the motion.
        motion: Box<MotionHeader>,
    },
    /// A simulated body.
    Body {
        /// The choices of the run.
        config: Box<Config>,
        /// What it is to move like, where there are recordings.
        recordings: Option<Recordings>,
    },
}

/// The motions of a library, whose model is not known yet.
pub struct Recordings {
    motions: Vec<Recording>,
}

struct Recording {
    name: String,
    kind: String,
    share: f32,
    rate: f32,
    frames: usize,
    /// `[frames][positions]`
    q: Vec<f32>,
}

/// The contents of the file.
pub struct RunFile {
    /// Name of the task.
    pub task: String,
    /// Environment steps that the policy has learned from.
    pub steps: u64,
    /// Who acts.
    pub policy: Policy,
    /// What is played.
    pub played: Played,
}

impl RunFile {
    /// The file.
    ///
    /// # Errors
    /// None: all of it is in host memory and has a JSON form.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        let mut sections = Sections::default();
        let mut run = Section::default();
        run.put("task", &self.task);
        run.put("steps", self.steps);
        match &self.played {
            Played::Locomotion { task, motion } => {
                run.put("locomotion", task);
                run.put("motion", motion);
            }
            Played::Body { config, recordings } => {
                run.put("config", config.to_toml());
                run.put("recorded", recordings.is_some());
                if let Some(recordings) = recordings {
                    sections.put("recordings", recordings.to_section());
                }
            }
        }
        sections.put("run", run);
        let mut policy = Section::default();
        put_policy(&mut policy, &self.policy)?;
        sections.put("policy", policy);
        Ok(sections.to_bytes(Path::new(NAME), FORMAT)?)
    }

    /// Reads the file.
    ///
    /// # Errors
    /// It is damaged, or of another version.
    pub fn from_bytes(bytes: &[u8]) -> Result<RunFile> {
        let mut sections = Sections::from_bytes(Path::new(NAME), bytes, FORMAT)?;
        let mut read = || -> Result<RunFile, SectionError> {
            let run = sections.take("run")?;
            let played = match run.get::<LocomotionTask>("locomotion") {
                Ok(task) => Played::Locomotion {
                    task,
                    motion: Box::new(run.get("motion")?),
                },
                Err(_) => body(&run, &mut sections)?,
            };
            Ok(RunFile {
                task: run.get("task")?,
                steps: run.get("steps")?,
                policy: take_policy(&mut sections.take("policy")?)?,
                played,
            })
        };
        let damaged = |SectionError(why)| StoreError::Damaged {
            path: NAME.into(),
            why,
        };
        Ok(read().map_err(damaged)?)
    }
}

fn body(run: &Section, sections: &mut Sections) -> Result<Played, SectionError> {
    let text: String = run.get("config")?;
    let mut config: Config = toml::from_str(&text)
        .map_err(|error| SectionError(format!("its configuration: {error}")))?;
    // All of it is in this file.
    (config.data, config.data_folder, config.roles) = (None, None, None);
    let recordings = match run.get("recorded")? {
        true => Some(Recordings::from_section(&mut sections.take("recordings")?)?),
        false => None,
    };
    Ok(Played::Body {
        config: Box::new(config),
        recordings,
    })
}

/// A policy without its critic, which only training needs.
fn put_policy(to: &mut Section, policy: &Policy) -> Result<()> {
    let actor = policy.networks().actor.span();
    to.put("network", policy.config());
    to.put("observation", policy.observation());
    to.put("action", policy.action());
    to.put("normalized", policy.normalizer.is_some());
    to.put_array("actor", &policy.parameters[actor]);
    let normalizer = policy.normalizer.as_ref();
    normalizer.map_or(Ok(()), |normalizer| normalizer.save(to))
}

fn take_policy(from: &mut Section) -> Result<Policy, SectionError> {
    let config: NetworkConfig = from.get("network")?;
    let observation: ObservationSpec = from.get("observation")?;
    let policy = Policy::new(&config, &observation, from.get("action")?, 1);
    let mut policy = policy.map_err(|error| SectionError(format!("its network: {error}")))?;
    let actor = policy.networks().actor.span();
    policy.parameters[actor.clone()].copy_from_slice(&from.take_finite("actor", actor.len())?);
    if from.get("normalized")? {
        policy.normalizer = Some(RunningMeanStd::load(from, observation.dim())?);
    }
    Ok(policy)
}

impl Recordings {
    /// Those of a library.
    pub fn of(library: &MotionLibrary) -> Recordings {
        let motions = library.motions().iter().enumerate();
        let motions = motions.map(|(number, motion)| Recording {
            name: motion.name.clone(),
            kind: library.kind(number).to_string(),
            share: library.share(number),
            rate: motion.rate,
            frames: motion.frames,
            q: motion.q.clone(),
        });
        Recordings {
            motions: motions.collect(),
        }
    }

    /// The library of a model's motions.
    ///
    /// # Errors
    /// They are of another model.
    pub fn library(self, model: &Arc<Model>) -> Result<MotionLibrary> {
        let motions = self.motions.iter();
        let motions = motions.map(|recorded| {
            MotionClip::new(&recorded.name, model, recorded.rate, recorded.q.clone())
        });
        let library = MotionLibrary::new(motions.collect(), model)?;
        let shares: Vec<f32> = self.motions.iter().map(|recorded| recorded.share).collect();
        let kinds = self.motions.into_iter().map(|recorded| recorded.kind);
        let library = library.weighted(&shares).context("the recordings")?;
        Ok(library.with_kinds(kinds.collect())?)
    }

    fn to_section(&self) -> Section {
        let mut section = Section::default();
        let about: Vec<_> = self.motions.iter().map(Recording::about).collect();
        section.put("motions", &about);
        for (number, motion) in self.motions.iter().enumerate() {
            let columns = QuantisedColumns::of(&motion.q, motion.q.len() / motion.frames);
            put_columns(&mut section, &format!("q{number}"), &columns);
        }
        section
    }

    fn from_section(section: &mut Section) -> Result<Recordings, SectionError> {
        let about: Vec<(String, String, f32, f32, usize, usize)> = section.get("motions")?;
        let motions = about.into_iter().enumerate().map(|(number, about)| {
            let (name, kind, share, rate, frames, width) = about;
            Ok(Recording {
                name,
                kind,
                share,
                rate,
                frames,
                q: take_columns(section, &format!("q{number}"), width, frames)?,
            })
        });
        Ok(Recordings {
            motions: motions.collect::<Result<_, SectionError>>()?,
        })
    }
}

impl Recording {
    /// Name, kind, share, rate, frames, positions of a frame.
    fn about(&self) -> (&str, &str, f32, f32, usize, usize) {
        let width = self.q.len() / self.frames;
        (
            &self.name,
            &self.kind,
            self.share,
            self.rate,
            self.frames,
            width,
        )
    }
}
