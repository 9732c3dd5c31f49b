//! One query of motion matching: which recorded frame goes on from a pose to walk straight ahead?
//!
//! You learn what a query is made of, and how the nearest of all frames is found.
//!
//! `cargo run --release --no-default-features --example match_one_query [-- FOLDER_OF_BVH_FILES]`

use anyhow::Context;
use footwork::motion::RATE;
use footwork::motion::features::{FRAMES_PER_STEP, POSE_DIM, TRAJECTORY_OFFSETS};
use footwork::motion::import::{ImportOptions, import};
use footwork::prelude::*;
use std::path::Path;
use std::sync::Arc;

/// Requested speed, m/s.
const SPEED: f32 = 1.2;

fn main() -> anyhow::Result<()> {
    let (clips, roles) = match std::env::args_os().nth(1) {
        Some(folder) => {
            let motion = import(Path::new(&folder), &ImportOptions::default())?;
            (motion.clips, motion.roles)
        }
        None => synthetic::perform(1, 4.0),
    };
    let database = Database::build(&clips, roles, Weights::PAPER)?;
    let matcher = MotionMatcher::new(Arc::new(database));
    let database = &matcher.database;

    // A frame of somebody who walks ahead, at 1 m/s or faster.
    let at = |frame: usize| PlacedFrame {
        frame,
        at: [0.0; 2],
        heading: [0.0, 1.0],
    };
    let speed = |frame: u32| {
        let [_, z] = at(frame as usize).on(database, FRAMES_PER_STEP as isize).at;
        z * RATE / FRAMES_PER_STEP as f32
    };
    let mut frames = database.candidates.iter().copied();
    let shown = frames.find(|&frame| speed(frame) >= 1.0);
    let shown = shown.context("nobody walks")?;

    // A query is the pose of the frame that is shown, and a position and a heading for each offset: here
    // straight ahead. All of it is normalised.
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
    // From where the character is, facing +z, it goes on as in these frames.
    for ahead in 1..=FRAMES_PER_STEP {
        let [x, z] = at(first).on(database, ahead as isize).at;
        println!("after {ahead} frames: {x:.2}, {z:.2} m");
    }
    Ok(())
}
