//! Databases of any size out of one: beyond its own length by mirrored and time-warped copies of its
//! clips.

use crate::motion::RATE;
use crate::motion::clip::Clip;
use crate::motion::database::Database;
use crate::motion::mirror::mirror;
use crate::motion::normalise::Weights;
use crate::motion::resample::resample;
use crate::train::data;
use anyhow::Result;
use std::path::Path;
use std::sync::Arc;

/// The motion that is measured on.
pub struct BenchData {
    pub database: Arc<Database>,
    clips: Vec<Clip>,
}

/// Difference in speed from one warped copy to the next, in alternation faster and slower.
const WARP: f32 = 0.03;

impl BenchData {
    /// Loads a database file, a BVH file or a folder of them; without a path the synthetic performer's
    /// motion.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn load(path: Option<&Path>) -> Result<Self> {
        let (database, _) = data::load(path, Weights::PAPER)?;
        let clips = (0..database.clips.len()).map(|clip| database.recording(clip));
        Ok(BenchData {
            clips: clips.collect(),
            database: Arc::new(database),
        })
    }

    /// A database with so many candidates, or a few less where a clip cannot be mirrored.
    ///
    /// # Errors
    /// No clip is long enough.
    pub fn with_candidates(&self, candidates: usize) -> Result<Database> {
        let mut clips = Vec::new();
        let mut frames = 0;
        // Every clip loses a second of candidates, and missing copies are not waited for.
        for copy in 0..4 * candidates.div_ceil(self.database.candidates.len()) {
            for clip in &self.clips {
                if frames >= candidates {
                    break;
                }
                let clip = self::copy(clip, copy);
                frames += clip.frames().saturating_sub(30);
                clips.push(clip);
            }
        }
        let Database { roles, weights, .. } = *self.database;
        let mut database = Database::build(&clips, roles, weights)?;
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
