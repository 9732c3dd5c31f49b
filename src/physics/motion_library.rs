//! Motions to begin from, and to follow: drawn by weight, at any time within.

use super::model::Model;
use super::motion_clip::MotionClip;
use super::retarget::{self, retarget};
use crate::motion::clip::Clip;
use crate::motion::error as motion;
use crate::motion::import::{ImportOptions, import};
use crate::motion::roles::Roles;
use rayon::prelude::*;
use std::path::Path;
use std::sync::Arc;

/// A result of making a library of motions.
pub type Result<T> = std::result::Result<T, MotionLibraryError>;

/// Why there is no library.
#[derive(Debug, thiserror::Error)]
pub enum MotionLibraryError {
    /// No motions.
    #[error(
        "a library needs motions, and none was given: name BVH files or folders that hold some"
    )]
    Empty,
    /// Files that cannot be imported.
    #[error(transparent)]
    Motion(#[from] motion::MotionError),
    /// A clip that cannot be put into the model's body.
    #[error("the clip '{clip}' cannot be put into the body: {error}")]
    Retarget {
        /// Name of the clip.
        clip: String,
        /// What the clip, its skeleton or the model lacks.
        error: retarget::RetargetError,
    },
    /// A motion whose frames do not have as many positions as the model.
    #[error("'{motion}' does not fit the model '{model}': it was made for another")]
    Model {
        /// Name of the motion.
        motion: String,
        /// Name of the library's model.
        model: String,
    },
    /// More or fewer weights than motions.
    #[error("{weights} weights were given for {motions} motions; give one for each")]
    Weights {
        /// Number of weights given.
        weights: usize,
        /// Number of motions in the library.
        motions: usize,
    },
    /// More or fewer kinds than motions.
    #[error("{kinds} kinds were given for {motions} motions; give one for each")]
    Kinds {
        /// Number of kinds given.
        kinds: usize,
        /// Number of motions in the library.
        motions: usize,
    },
    /// A negative weight, or weights whose sum is not positive and finite.
    #[error(
        "the weight of '{motion}' is {weight}, that of all motions {total}: give weights of zero or more, not all zero"
    )]
    Weight {
        /// Name of the first motion with a negative weight or, where the sum is wrong, of the very first.
        motion: String,
        /// Weight of that motion.
        weight: f32,
        /// Sum of all weights.
        total: f32,
    },
}

/// Motions of one model, each as likely to be drawn as its share of all weights.
#[derive(Clone, Debug)]
pub struct MotionLibrary {
    model: Arc<Model>,
    motions: Vec<MotionClip>,
    /// What kind of motion each is, empty where nobody said.
    kinds: Vec<String>,
    /// Shares of the weights of each motion and all before it.
    shares: Vec<f32>,
    /// One sentence each: clips left out, T-poses dropped, unusual units.
    pub notes: Vec<String>,
}

impl MotionLibrary {
    /// A library of BVH files and folders of them, as [`import`] reads them. Longer clips weigh more.
    ///
    /// # Errors
    /// No paths, files that cannot be read, folders without recordings or with only short ones,
    /// skeletons that cannot be put into the body.
    pub fn load<P: AsRef<Path>>(
        paths: &[P],
        options: &ImportOptions,
        model: &Arc<Model>,
    ) -> Result<MotionLibrary> {
        let (mut motions, mut notes) = (Vec::new(), Vec::new());
        for path in paths {
            let import = import(path.as_ref(), options)?;
            motions.extend(retargeted(&import.clips, &import.roles, model)?);
            notes.extend(import.notes);
        }
        let library = MotionLibrary::new(motions, model)?;
        Ok(MotionLibrary { notes, ..library })
    }

    /// A library of clips of one skeleton. Longer clips weigh more.
    ///
    /// # Errors
    /// No clips, a skeleton that cannot be put into the body.
    pub fn of(clips: &[Clip], roles: &Roles, model: &Arc<Model>) -> Result<MotionLibrary> {
        MotionLibrary::new(retargeted(clips, roles, model)?, model)
    }

    /// A library of motions of one model. Longer motions weigh more.
    ///
    /// # Errors
    /// No motions, motions of another model.
    pub fn new(motions: Vec<MotionClip>, model: &Arc<Model>) -> Result<MotionLibrary> {
        let frames = |motion: &MotionClip| motion.q.len() / model.nq();
        if let Some(motion) = motions
            .iter()
            .find(|motion| frames(motion) != motion.frames)
        {
            return Err(MotionLibraryError::Model {
                motion: motion.name.clone(),
                model: model.name.clone(),
            });
        }
        let weights: Vec<f32> = motions.iter().map(MotionClip::seconds).collect();
        let library = MotionLibrary {
            model: model.clone(),
            kinds: vec![String::new(); motions.len()],
            motions,
            shares: Vec::new(),
            notes: Vec::new(),
        };
        library.weighted(&weights)
    }

    /// Sets the weights by which motions are drawn.
    ///
    /// # Errors
    /// Weights that are negative, no numbers, all zero, or not one for each motion.
    pub fn weighted(mut self, weights: &[f32]) -> Result<MotionLibrary> {
        let motions = &self.motions;
        if motions.is_empty() {
            return Err(MotionLibraryError::Empty);
        }
        if weights.len() != motions.len() {
            return Err(MotionLibraryError::Weights {
                weights: weights.len(),
                motions: motions.len(),
            });
        }
        let total: f32 = weights.iter().sum();
        let possible = total > 0.0 && total.is_finite();
        let wrong = weights.iter().position(|&weight| !possible || weight < 0.0);
        if let Some(wrong) = wrong {
            return Err(MotionLibraryError::Weight {
                motion: motions[wrong].name.clone(),
                weight: weights[wrong],
                total,
            });
        }
        let sums = weights.iter().scan(0.0, |sum, weight| {
            *sum += weight;
            Some(*sum / total)
        });
        self.shares = sums.collect();
        Ok(self)
    }

    /// Sets what kind of motion each is, like "boxing".
    ///
    /// # Errors
    /// Not one kind for each motion.
    pub fn with_kinds(mut self, kinds: Vec<String>) -> Result<MotionLibrary> {
        if kinds.len() != self.motions.len() {
            return Err(MotionLibraryError::Kinds {
                kinds: kinds.len(),
                motions: self.motions.len(),
            });
        }
        self.kinds = kinds;
        Ok(self)
    }

    /// The motions, in the order of the indices that [`sample`](Self::sample) draws.
    pub fn motions(&self) -> &[MotionClip] {
        &self.motions
    }

    /// The model that all motions are of.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// The kind of a motion, empty if it has none.
    pub fn kind(&self, motion: usize) -> &str {
        &self.kinds[motion]
    }

    /// How likely a motion is to be drawn, from 0 to 1.
    pub fn share(&self, motion: usize) -> f32 {
        let before = motion.checked_sub(1).map_or(0.0, |one| self.shares[one]);
        self.shares[motion] - before
    }

    /// A motion by weight, and a time within it, s, all of which are as likely: of two random numbers, at least 0
    /// and less than 1.
    pub fn sample(&self, [share, time]: [f32; 2]) -> (usize, f32) {
        // The last of the shares is one.
        let motion = self.shares.partition_point(|&upto| upto <= share);
        (motion, time * self.motions[motion].seconds())
    }

    /// Positions and velocities of a motion so many seconds after its first frame.
    pub fn at(&self, motion: usize, time: f32) -> (Vec<f32>, Vec<f32>) {
        self.motions[motion].at(&self.model, time)
    }
}

fn retargeted(clips: &[Clip], roles: &Roles, model: &Model) -> Result<Vec<MotionClip>> {
    let motions: Vec<Result<MotionClip>> = clips
        .par_iter()
        .map(|clip| {
            retarget(clip, roles, model).map_err(|error| MotionLibraryError::Retarget {
                clip: clip.name.clone(),
                error,
            })
        })
        .collect();
    motions.into_iter().collect()
}
