//! One query of motion matching: which recorded frame goes on from a pose to walk straight ahead?
//!
//! `cargo run --release --no-default-features --example match_one_query -- FOLDER_OF_BVH_FILES`

use anyhow::{Context, Result};
use footwork::matching::MotionMatcher;
use footwork::motion::RATE;
use footwork::motion::database::Database;
use footwork::motion::features::{FRAMES_PER_STEP, POSE_DIM, TRAJECTORY_OFFSETS};
use footwork::motion::import::{ImportOptions, import};
use footwork::motion::normalise::Weights;
use std::path::PathBuf;
use std::sync::Arc;

/// Requested speed, m/s.
const SPEED: f32 = 1.2;

fn main() -> Result<()> {
    let folder = std::env::args_os().nth(1);
    let folder = PathBuf::from(folder.context("usage: match_one_query FOLDER_OF_BVH_FILES")?);
    let motion = import(&folder, &ImportOptions::default())?;
    let database = Database::build(&motion.clips, motion.roles, Weights::PAPER)?;
    let matcher = MotionMatcher::new(Arc::new(database));
    let database = &matcher.database;

    // The pose of a recorded frame, and a position and a heading, both straight ahead, for each offset.
    let shown = database.candidates[0];
    let mut query = database.features[shown as usize];
    let normal = &database.normalisation;
    for (part, ahead) in TRAJECTORY_OFFSETS.into_iter().enumerate() {
        let requested = [0.0, SPEED * ahead as f32 / RATE, 0.0, 1.0];
        for (i, value) in (POSE_DIM + 4 * part..).zip(requested) {
            query[i] = (value - normal.mean[i]) * normal.scale[i];
        }
    }

    let nearest = matcher.nearest(shown, &query);
    let first = database.candidates[nearest.index as usize] as usize;
    let clip = database.clip(first);
    println!(
        "{} from frame {} on, at a squared distance of {:.2}",
        clip.name,
        first - clip.first,
        nearest.distance
    );
    for frame in first..=first + FRAMES_PER_STEP {
        let [x, z, ..] = database.path[frame];
        println!("frame {}: {x:.2}, {z:.2} m", frame - clip.first);
    }
    Ok(())
}
