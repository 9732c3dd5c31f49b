//! Databases of any size out of one recording session: beyond its own length mirrored and
//! time-warped copies of its clips.

use crate::motion::RATE;
use crate::motion::clip::Clip;
use crate::motion::database::Database;
use crate::motion::import::{ImportOptions, import};
use crate::motion::mirror::mirror;
use crate::motion::normalise::Weights;
use crate::motion::synthetic;
use crate::motion::resample::resample;
use crate::motion::roles::Roles;
use crate::train::data::SYNTHETIC_SEED;
use anyhow::{Result, ensure};
use std::path::Path;
use std::sync::Arc;

/// Clips at 30 Hz.
pub struct Motion {
    clips: Vec<Clip>,
    roles: Roles,
    whole: Arc<Database>,
}

/// How much faster a copy is than another, in alternation with slower.
const WARP: f32 = 0.03;

impl Motion {
    /// A BVH file or a folder of them; without a path the synthetic performer's motion.
    pub fn load(path: Option<&Path>) -> Result<Self> {
        let (clips, roles) = match path {
            None => synthetic::perform(SYNTHETIC_SEED, synthetic::MINUTES),
            Some(path) => {
                let bvh = path
                    .extension()
                    .is_some_and(|end| end.eq_ignore_ascii_case("bvh"));
                ensure!(
                    path.is_dir() || bvh || !path.exists(),
                    "{} is no folder and no .bvh file: larger databases are made from recordings, which a database \
                     file no longer has",
                    path.display()
                );
                let import = import(path, &ImportOptions::default())?;
                (import.clips, import.roles)
            }
        };
        Ok(Motion {
            whole: Arc::new(Database::build(&clips, roles, Weights::PAPER)?),
            clips,
            roles,
        })
    }

    /// As it is.
    pub fn whole(&self) -> Arc<Database> {
        self.whole.clone()
    }

    /// With so many candidates, or a few less where a mirrored copy is not to be had.
    pub fn of(&self, candidates: usize) -> Result<Database> {
        let mut clips = Vec::new();
        let mut frames = 0;
        // Every clip loses a second of candidates, and what no copy can add is not waited for.
        for copy in 0..4 * candidates.div_ceil(self.whole.candidates.len()) {
            for clip in &self.clips {
                if frames >= candidates {
                    break;
                }
                let clip = self::copy(clip, copy);
                frames += clip.frames().saturating_sub(30);
                clips.push(clip);
            }
        }
        let mut database = Database::build(&clips, self.roles, Weights::PAPER)?;
        database.candidates.truncate(candidates);
        Ok(database)
    }
}

/// The clip itself, its mirror image, then both faster, slower, still faster, and so on.
fn copy(clip: &Clip, number: usize) -> Clip {
    let warp = number / 2;
    let side = if warp.is_multiple_of(2) { -1.0 } else { 1.0 };
    let mut copy = match number % 2 {
        0 => clip.clone(),
        _ => mirror(clip).unwrap_or_else(|_| clip.clone()),
    };
    copy.rate = RATE * (1.0 + side * WARP * warp.div_ceil(2) as f32);
    resample(copy)
}
