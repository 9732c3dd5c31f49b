//! A database made ready to move characters.

use crate::container::StoreError;
use crate::matching::MotionMatcher;
use crate::motion::database::Database;
use crate::motion::features::{FEATURE_DIM, POSE_DIM};
use crate::playback::player::Feet;
use std::path::Path;
use std::sync::Arc;

/// The motion, its index, the feet of its skeleton, and the frame that characters begin with.
pub struct CharacterMotion {
    /// The motion and its index.
    pub matcher: MotionMatcher,
    /// Legs and contacts of the motion.
    pub feet: Arc<Feet>,
    /// The candidate frame that is nearest to standing still.
    pub rest: usize,
}

impl CharacterMotion {
    /// Makes a database ready.
    pub fn new(matcher: MotionMatcher) -> Self {
        CharacterMotion {
            feet: Arc::new(Feet::of(&matcher.database)),
            rest: rest(&matcher.database),
            matcher,
        }
    }

    /// Reads a database file, and the index beside it; without one the index is built.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        let database = Arc::new(Database::load(path)?);
        Ok(Self::new(MotionMatcher::open(database, path)))
    }

    /// The motion.
    pub fn database(&self) -> &Arc<Database> {
        &self.matcher.database
    }
}

/// The first feature that is a velocity.
const VELOCITIES: usize = 6;

/// The candidate whose velocities and trajectory are nearest to those of somebody who stands.
fn rest(database: &Database) -> usize {
    let normal = &database.normalisation;
    let still = |i: usize| {
        // Of every trajectory point the heading's z is the fourth number.
        let ahead = i >= POSE_DIM && (i - POSE_DIM) % 4 == 3;
        (f32::from(u8::from(ahead)) - normal.mean[i]) * normal.scale[i]
    };
    let still: [f32; FEATURE_DIM] = std::array::from_fn(still);
    let away = |&frame: &u32| {
        let row = &database.features[frame as usize];
        let differences = (VELOCITIES..FEATURE_DIM).map(|i| (row[i] - still[i]).powi(2));
        differences.sum::<f32>()
    };
    let frames = database.candidates.iter();
    let nearest = frames.min_by(|a, b| away(a).total_cmp(&away(b)));
    nearest.map_or(0, |&frame| frame as usize)
}
