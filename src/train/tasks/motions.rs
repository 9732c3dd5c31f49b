//! The recordings that a simulated body is to move like.

use crate::motion::import::ImportOptions;
use crate::motion::synthetic;
use crate::physics::model::Model;
use crate::physics::motion_library::MotionLibrary;
use crate::train::data::SYNTHETIC_SEED;
use anyhow::Result;
use std::path::Path;
use std::sync::Arc;

/// Minutes of the synthetic performer that a body is to move like, if there are no recordings.
const MINUTES: f32 = 2.0;

/// Loads recordings of a model's body; without a path, the synthetic performer's motion. The notes say what
/// the user should know of them.
///
/// # Errors
/// They are missing or damaged, or of nobody that the body could move like.
pub fn load(path: Option<&Path>, model: &Arc<Model>) -> Result<(MotionLibrary, Vec<String>)> {
    let Some(path) = path else {
        let (clips, roles) = synthetic::perform(SYNTHETIC_SEED, MINUTES);
        let note = "no data given: synthetic motion of the built-in performer".to_string();
        return Ok((MotionLibrary::of(&clips, &roles, model)?, vec![note]));
    };
    let library = MotionLibrary::load(&[path], &ImportOptions::default(), model)?;
    let notes = library.notes.clone();
    Ok((library, notes))
}

/// A fingerprint of all positions of a library.
pub fn fingerprint(library: &MotionLibrary) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    for (number, motion) in library.motions().iter().enumerate() {
        hasher.update(bytemuck::cast_slice(&motion.q));
        hasher.update(&library.share(number).to_le_bytes());
    }
    hasher.finalize()
}

/// A library in a few words.
pub fn describe(library: &MotionLibrary) -> String {
    let motions = library.motions();
    let seconds: f32 = motions.iter().map(|motion| motion.seconds()).sum();
    match motions {
        [motion] => format!("the clip {} of {seconds:.1} s", motion.name),
        _ => format!("{} clips of {seconds:.1} s", motions.len()),
    }
}
