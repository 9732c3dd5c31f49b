//! A run at one moment, complete: it goes on from here as if it had never stopped.
//!
//! A file of sections. `run` says of what run it is, `policy` is enough to evaluate; `learner`, `envs.*`,
//! `curriculum` and `trainer` are what the training goes on with.

use super::config::{Config, Difference, VERSION};
use super::fingerprint::Fingerprint;
use super::state::TrainerState;
use crate::container::{Format, Section, SectionError, Sections, StoreError};
use crate::env::EnvSpec;
use crate::env::batch::{ENVS, EnvBatch};
use crate::nn::Policy;
use crate::ranks::Ranks;
use crate::rl::Algorithm;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

const FORMAT: Format = Format {
    kind: "checkpt",
    version: 7,
};

/// The run that a checkpoint is of, and how far it had come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// The program that wrote it.
    pub version: String,
    /// The task's name.
    pub task: String,
    /// Dimensions of the environments.
    pub spec: EnvSpec,
    /// Fingerprint of what the policy was trained with.
    #[serde(flatten)]
    pub fingerprint: Fingerprint,
    /// The resolved configuration, as in `config.toml`.
    pub config: String,
    /// Environment steps so far.
    pub steps: u64,
}

/// A run at one moment.
pub struct Checkpoint {
    /// The section `run`.
    pub header: Header,
    /// The section `policy`.
    pub policy: Policy,
    /// All but `run`.
    pub sections: Sections,
    /// Where it was read from; empty if it was taken just now.
    pub path: PathBuf,
}

/// Why a checkpoint is of no use.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// A file that cannot be read or written, is damaged, or is no checkpoint of this format.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A file of a format that this version no longer reads.
    #[error(
        "{path} was written by an earlier footwork 0.1 (format {format}). This is footwork {VERSION}, which does not read it: use the one that wrote it, or train anew"
    )]
    Older {
        /// The checkpoint.
        path: PathBuf,
        /// Version of its format.
        format: u32,
    },
    /// A policy trained on other data.
    #[error(
        "{path} was trained with other data (fingerprint {found:08x}, this has {wanted:08x}): bring back what the run was started with or name it with --data, or start another run"
    )]
    Data {
        /// The checkpoint.
        path: PathBuf,
        /// Fingerprint of the data it was trained on.
        found: u32,
        /// Fingerprint of the data at hand.
        wanted: u32,
    },
    /// A policy that steers another low level.
    #[error(
        "{path} was trained over another low level (fingerprint {found:08x}, this has {wanted:08x}): bring back the one that the run was started with or name it with --skills, or start another run"
    )]
    LowLevel {
        /// The checkpoint.
        path: PathBuf,
        /// Fingerprint of the low level it was trained over.
        found: u32,
        /// Fingerprint of the low level at hand.
        wanted: u32,
    },
    /// A configuration that has changed since the run was started.
    #[error(
        "`{key}` in the run's config.toml is not what the run was started with: put it back, or start another run"
    )]
    Changed {
        /// First key that differs, like `ppo.gamma`.
        key: String,
    },
    /// A configuration of a version with other choices.
    #[error(
        "the run was started by a version of footwork that differs by the choice `{key}`: go on with that version, or start another run"
    )]
    Version {
        /// First key that only one of the two versions knows, like `self_play.scripted`.
        key: String,
    },
    /// A checkpoint of another task.
    #[error("{path} is of the task `{found}`, not of `{wanted}`")]
    Task {
        /// The checkpoint.
        path: PathBuf,
        /// Name of its task.
        found: String,
        /// Name of the task at hand.
        wanted: String,
    },
    /// A run that another cannot begin with.
    #[error("the run cannot begin with the one given by --from: {0}")]
    Start(String),
    /// A checkpoint of environments with other dimensions.
    #[error("{path} is of environments with {found}, not with {wanted}: start another run")]
    Spec {
        /// The checkpoint.
        path: PathBuf,
        /// Its numbers of observations and actions, in words.
        found: String,
        /// Those of the environments at hand, in words.
        wanted: String,
    },
}

impl Checkpoint {
    /// Copies a run's state to the host, that of the environments of all ranks.
    ///
    /// # Errors
    /// The device was lost; or this rank's policy is no longer the first one's.
    pub fn take(
        header: Header,
        learner: &dyn Algorithm,
        envs: &EnvBatch,
        state: &TrainerState,
    ) -> anyhow::Result<Self> {
        let policy = learner.policy()?;
        check_agreement(&envs.ranks, policy.hash())?;
        let mut sections = saved_envs(envs)?;
        let mut section = Section::default();
        policy.save(&mut section)?;
        sections.put("policy", section);
        let mut section = Section::default();
        learner.save(&mut section)?;
        sections.put("learner", section);
        let mut section = Section::default();
        state.save(&mut section);
        sections.put("trainer", section);
        Ok(Checkpoint {
            header,
            policy,
            sections,
            path: PathBuf::new(),
        })
    }

    /// Writes the file, whole or not at all.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), StoreError> {
        let mut sections = self.sections.clone();
        let mut run = Section::default();
        run.put("run", &self.header);
        sections.put("run", run);
        sections.save(path, FORMAT)
    }

    /// Reads a file, and of its sections what evaluation needs.
    ///
    /// # Errors
    /// It cannot be read, is damaged, or of another version.
    pub fn load(path: &Path) -> Result<Self, CheckpointError> {
        let mut sections = Sections::load(path, FORMAT).map_err(|error| match error {
            StoreError::Older { path, found, .. } => CheckpointError::Older {
                path,
                format: found,
            },
            other => other.into(),
        })?;
        let mut read = || -> Result<(Header, Policy), SectionError> {
            let header = sections.take("run")?.get("run")?;
            Ok((header, Policy::load(&mut sections.get("policy")?.clone())?))
        };
        let (header, policy) = read().map_err(|error| damaged(path, error))?;
        Ok(Checkpoint {
            header,
            policy,
            sections,
            path: path.to_path_buf(),
        })
    }

    /// Reads a checkpoint for a task with its data and its low level.
    ///
    /// # Errors
    /// It cannot be read, or is of another task, of other environments, other data or another low level.
    pub fn load_for(
        path: &Path,
        task: &str,
        spec: &EnvSpec,
        fingerprint: Fingerprint,
    ) -> Result<Self, CheckpointError> {
        let checkpoint = Self::load(path)?;
        let (found, path) = (&checkpoint.header, path.to_path_buf());
        if found.task != task {
            let (found, wanted) = (found.task.clone(), task.to_string());
            return Err(CheckpointError::Task {
                path,
                found,
                wanted,
            });
        }
        let dims = |spec: &EnvSpec| {
            let (observation, action) = (spec.observation.dim(), spec.action);
            format!("{observation} observations and {action} actions")
        };
        if dims(&found.spec) != dims(spec) {
            return Err(CheckpointError::Spec {
                path,
                found: dims(&found.spec),
                wanted: dims(spec),
            });
        }
        let (found, wanted) = (found.fingerprint, fingerprint);
        if found.data != wanted.data {
            let (found, wanted) = (found.data, wanted.data);
            return Err(CheckpointError::Data {
                path,
                found,
                wanted,
            });
        }
        if found.low_level != wanted.low_level {
            let (found, wanted) = (found.low_level, wanted.low_level);
            return Err(CheckpointError::LowLevel {
                path,
                found,
                wanted,
            });
        }
        Ok(checkpoint)
    }

    /// Refuses to go on under another configuration than the one that the run was started with.
    ///
    /// # Errors
    /// [`CheckpointError::Changed`] or [`CheckpointError::Version`].
    pub fn check_same(&self, config: &Config) -> Result<(), CheckpointError> {
        match config.difference(&self.header.config) {
            None => Ok(()),
            // Whatever the file leaves out, a configuration names all choices of its version.
            Some(Difference { key, in_both }) => Err(match in_both {
                true => CheckpointError::Changed { key },
                false => CheckpointError::Version { key },
            }),
        }
    }

    /// Lets a fresh learner of another run begin with what this one has learned.
    ///
    /// # Errors
    /// It does not fit.
    pub fn start(&self, learner: &mut dyn Algorithm) -> Result<(), CheckpointError> {
        let mut section = self.sections.get("learner").cloned().unwrap_or_default();
        let started = learner.start_from(&self.policy, &mut section);
        started.map_err(|error| CheckpointError::Start(error.0))
    }

    /// Puts the state back into a fresh learner and environments of the same configuration.
    ///
    /// # Errors
    /// A section is missing or damaged.
    pub fn restore(
        mut self,
        learner: &mut dyn Algorithm,
        envs: &mut EnvBatch,
    ) -> Result<Restored, CheckpointError> {
        let parts = self.sections.names();
        let parts = parts.filter(|name| name.starts_with(ENVS)).count();
        let same = parts == envs.parts.len() * envs.ranks.count();
        let mut restore = || -> Result<Restored, SectionError> {
            learner.load(&mut self.sections.take("learner")?, &self.policy)?;
            match same {
                true => envs.load(|name| self.sections.take(name))?,
                false => envs.load_level(|name| self.sections.take(name))?,
            }
            Ok(Restored {
                state: TrainerState::load(&mut self.sections.take("trainer")?)?,
                envs: same,
            })
        };
        restore().map_err(|error| damaged(&self.path, error))
    }
}

/// What a checkpoint was put back into.
pub struct Restored {
    /// What the trainer remembers.
    pub state: TrainerState,
    /// Whether the environments go on with their episodes. They begin new ones where another number of ranks shares them
    /// out otherwise.
    pub envs: bool,
}

/// The environments of all ranks.
fn saved_envs(envs: &EnvBatch) -> anyhow::Result<Sections> {
    let mut own = Sections::default();
    for (name, section) in envs.save()? {
        own.put(&name, section);
    }
    if envs.ranks.is_alone() {
        return Ok(own);
    }
    // On its way it has no place in a file system.
    let nowhere = Path::new("");
    let mut all = Sections::default();
    for sent in envs.ranks.gather(&own.to_bytes(nowhere, FORMAT)?) {
        all.extend(Sections::from_bytes(nowhere, &sent, FORMAT)?);
    }
    Ok(all)
}

/// Refuses to go on where a rank has another policy than the first.
fn check_agreement(ranks: &Ranks, hash: u32) -> anyhow::Result<()> {
    let mut first = hash.to_le_bytes().to_vec();
    ranks.broadcast(&mut first);
    anyhow::ensure!(
        first == hash.to_le_bytes(),
        "rank {} computes otherwise than the first, and has another policy by now: let all of them run on machines and \
         libraries of one kind",
        ranks.rank().number
    );
    Ok(())
}

fn damaged(path: &Path, error: SectionError) -> CheckpointError {
    let (path, why) = (path.to_path_buf(), error.0);
    StoreError::Damaged { path, why }.into()
}
