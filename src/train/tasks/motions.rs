//! What the tasks of a simulated body share: the recordings that it is to move like, and what learns it.

use crate::env::EnvBatch;
use crate::env::humanoid::punch::evaluate::BOXING;
use crate::env::humanoid::recorded::demonstrations;
use crate::gpu::Device;
use crate::motion::import::ImportOptions;
use crate::motion::synthetic;
use crate::physics::model::Model;
use crate::physics::motion_library::MotionLibrary;
use crate::physics::motion_list::{ClipReport, MotionList, MotionListOptions};
use crate::rl::Algorithm;
use crate::rl::amp::{Amp, AmpLearner, SkillRewards};
use crate::rl::ase::LatentDraw;
use crate::rl::gae::RewardSource;
use crate::rl::ppo::PpoLearner;
use crate::rl::task_weight::TaskWeight;
use crate::train::config::Config;
use crate::train::data::SYNTHETIC_SEED;
use crate::train::evaluation::EvalOptions;
use crate::train::task::Unsupported;
use anyhow::Result;
use std::sync::Arc;

/// Frames that a clip needs at least: half a second, of which every window is one of two.
const MIN_FRAMES: usize = 15;
/// Minutes of the performer's locomotion, and of its boxing.
const MINUTES: f32 = 2.0;
/// Seconds of a piece of that. Skills have a latent a clip, and who does many things in one cannot be told which to do.
const PIECE: f32 = 4.0;
/// Seconds of the performer's walk, and its speed, m/s.
const WALK: [f32; 2] = [12.0, 1.2];

/// What the built-in performer does where there are no recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Performance {
    /// A steady walk.
    Walk,
    /// Locomotion of all kinds, and boxing as often.
    Boxing,
}

/// Loads recordings of a model's body: a motion list, a folder or a file; without any, the synthetic
/// performer's motion. The notes say what the user should know of them.
///
/// # Errors
/// They are missing or damaged, or of nobody that the body could move like.
pub fn load(
    config: &Config,
    model: &Arc<Model>,
    performance: Performance,
) -> Result<(MotionLibrary, Vec<String>)> {
    let Some(path) = &config.data else {
        let note = "no data given: synthetic motion of the built-in performer".to_string();
        return Ok((performed(performance, model)?, vec![note]));
    };
    let list = MotionList::read(path, config.data_folder.as_deref())?;
    let options = MotionListOptions {
        import: ImportOptions {
            unit_m: config.unit_m,
            roles: config.roles.clone(),
            ..ImportOptions::default()
        },
        ground: config.ground,
        min_frames: MIN_FRAMES,
    };
    let loaded = list.load(model, &options)?;
    let mut notes = loaded.library.notes.clone();
    notes.extend(loaded.report.iter().map(line));
    Ok((loaded.library, notes))
}

/// The performer's motion in a model's body.
fn performed(performance: Performance, model: &Arc<Model>) -> Result<MotionLibrary> {
    if performance == Performance::Walk {
        let [seconds, speed] = WALK;
        let (clips, roles) = synthetic::perform_walk(SYNTHETIC_SEED, seconds, speed);
        return Ok(MotionLibrary::of(&clips, &roles, model)?);
    }
    let (walks, roles) = synthetic::perform(SYNTHETIC_SEED, MINUTES);
    let (fights, _) = synthetic::perform_boxing(SYNTHETIC_SEED, MINUTES);
    let (mut motions, mut kinds) = (Vec::new(), Vec::new());
    for (clips, kind) in [(walks, ""), (fights, BOXING)] {
        let whole = MotionLibrary::of(&clips, &roles, model)?;
        let whole = whole.motions().iter();
        motions.extend(whole.flat_map(|clip| clip.pieces(model, PIECE)));
        kinds.resize(motions.len(), kind.to_string());
    }
    // Both are as long: by their seconds, half of what is drawn is boxing.
    Ok(MotionLibrary::new(motions, model)?.with_kinds(kinds)?)
}

/// What came of a recording.
fn line(clip: &ClipReport) -> String {
    let [low, high] = clip.foot_height.map(|height| 100.0 * height);
    format!(
        "{}: {:.1} s, {:.1} % of what is drawn; lowest foot {low:.0} to {high:.0} cm high, {:.0} % of the \
         frames at a joint's limit, {} frames of T-pose dropped",
        clip.name,
        clip.seconds,
        100.0 * clip.share,
        100.0 * clip.limits_hit,
        clip.t_pose_frames
    )
}

/// PPO with a discriminator of the library's motion, which is shown the `latents` of clips where it is to.
///
/// # Errors
/// A network does not fit the observations, or the device.
pub fn learner(
    config: &Config,
    amp: &Amp,
    skills: &SkillRewards,
    latents: Option<&LatentDraw>,
    library: &MotionLibrary,
    envs: &EnvBatch,
    device: &Device,
) -> Result<Box<dyn Algorithm>> {
    let (ppo, seed) = (&config.ppo, config.seed);
    let latents = latents.filter(|_| skills.latents.shown() > 0);
    let latent = |clip: usize, window: usize| match latents {
        Some(draw) => draw.about_clip(clip, window),
        None => Vec::new(),
    };
    let demonstrations = Arc::new(demonstrations(library, latent));
    let learner = AmpLearner::new(ppo, amp, skills, &demonstrations, envs, device, seed)?;
    let weight = TaskWeight::new(&config.task_weight, amp.lambda());
    Ok(Box::new(learner.with_task_weight(weight)))
}

/// Weights of the task's reward and of the style's, which the low level's discriminator gives, where a low level is
/// steered (ASE's).
const STEERING_REWARDS: [(RewardSource, f32); 2] =
    [(RewardSource::Task, 0.9), (RewardSource::Style, 0.1)];

/// PPO of a policy that steers a low level, whose own style a rule for the weight of the task keeps to.
///
/// # Errors
/// A network does not fit the observations, or the device.
pub fn steering_learner(
    config: &Config,
    envs: &EnvBatch,
    device: &Device,
) -> Result<Box<dyn Algorithm>> {
    let (ppo, seed) = (&config.ppo, config.seed);
    let learner = PpoLearner::with_rewards(ppo, envs, device, seed, &STEERING_REWARDS)?;
    let [task, style] = STEERING_REWARDS.map(|(_, weight)| f64::from(weight));
    // The low level's own reward was measured under the noise of its actions, and would be too easy to reach: the
    // reference is found anew, from first decisions that are as good as random.
    let weight = TaskWeight::new(&config.task_weight, task / style);
    Ok(Box::new(learner.with_task_weight(weight)))
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
