//! What the tasks of a simulated body share: the recordings that it is to move like, and what learns it.

use crate::env::EnvBatch;
use crate::env::humanoid::recorded::demonstrations;
use crate::gpu::Device;
use crate::motion::import::ImportOptions;
use crate::motion::synthetic;
use crate::physics::model::Model;
use crate::physics::motion_library::MotionLibrary;
use crate::rl::Algorithm;
use crate::rl::amp::AmpLearner;
use crate::train::config::Config;
use crate::train::data::SYNTHETIC_SEED;
use crate::train::evaluation::EvalOptions;
use crate::train::task::Unsupported;
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

/// PPO with a discriminator of the library's motion.
///
/// # Errors
/// A network does not fit the observations, or the device.
pub fn learner(
    config: &Config,
    library: &MotionLibrary,
    envs: &EnvBatch,
    device: &Device,
) -> Result<Box<dyn Algorithm>> {
    let amp = config.amp.clone().unwrap_or_default();
    let (ppo, seed) = (&config.ppo, config.seed);
    let demonstrations = Arc::new(demonstrations(library));
    let learner = AmpLearner::new(ppo, &amp, &demonstrations, envs, device, seed)?;
    Ok(Box::new(learner))
}

/// Refuses what `footwork eval` has for motion matching alone.
///
/// # Errors
/// [`Unsupported`] if any of it is asked for.
pub fn refuse_matching(wanted: &EvalOptions) -> Result<()> {
    let beside = [
        ("--baseline", wanted.baseline),
        ("--planner", wanted.planner > 0),
        ("--motion-quality", wanted.motion_quality),
    ];
    match beside.into_iter().find(|(_, wanted)| *wanted) {
        None => Ok(()),
        Some((option, _)) => {
            let why =
                format!("{option} is for motion matching: a simulated body has no such thing");
            Err(Unsupported(why).into())
        }
    }
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
