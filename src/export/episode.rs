//! One of the evaluation's episodes, played.

use super::character::MovingCharacter;
use super::format::TrainedRun;
use crate::env::humanoid::task::play::record;
use crate::kernels::termination;
use crate::motion::RATE;
use crate::motion::clip::Clip;
use crate::motion::features::FRAMES_PER_STEP;
use crate::physics::motion_clip::MotionClip;
use crate::playback::player::Style;
use crate::train::body_episodes::BodyEpisodes;
use crate::train::locomotion::Locomotion;
use crate::train::playthrough::{Playthrough, PlaythroughContext};
use anyhow::{Result, bail};

/// The run's policy in the excerpt: all who move, who is driven before what is pushed.
///
/// # Errors
/// The policy cannot be evaluated.
pub fn characters(run: &TrainedRun) -> Result<Vec<MovingCharacter>> {
    let (task, excerpt) = (run.task, &run.excerpt);
    let name = format!("{} {}", run.config.task.name, excerpt.episode);
    match (task.locomotion(), task.body()) {
        (Some(locomotion), _) => Ok(vec![matched(run, locomotion, name)?]),
        (_, Some(body)) => Ok(simulated(run, &body, &name)),
        (None, None) => bail!("the task has no motion to show"),
    }
}

/// The whole body of a character of motion matching, joined and with its feet held.
fn matched(run: &TrainedRun, locomotion: &Locomotion, name: String) -> Result<MovingCharacter> {
    let matcher = locomotion.matcher.clone();
    let context = PlaythroughContext::new(matcher, locomotion.task, Style::BEST);
    let policy = &run.checkpoint.policy;
    let mut playthrough = Playthrough::new(&context, run.excerpt.episode);
    let mut poses = vec![playthrough.pose.clone()];
    while poses.len() < run.excerpt.frames(RATE) && !collided(&playthrough) {
        playthrough.advance(&context, policy)?;
        poses.push(playthrough.pose.clone());
    }
    let clip = Clip {
        name,
        skeleton: context.database().skeleton.clone(),
        rate: RATE,
        positions: poses.iter().map(|pose| pose.root).collect(),
        rotations: poses.into_iter().flat_map(|pose| pose.rotations).collect(),
        source: String::new(),
        licence: String::new(),
    };
    Ok(MovingCharacter {
        clip,
        bones: context.rig.bones.clone(),
        cuboids: Vec::new(),
    })
}

/// Whether the last step, all of which has been shown, ended at an obstacle.
fn collided(playthrough: &Playthrough) -> bool {
    let step = playthrough.step.as_ref();
    playthrough.played == FRAMES_PER_STEP
        && step.is_some_and(|step| step.termination == termination::FAILED)
}

/// Simulated bodies, and what they punch.
fn simulated(run: &TrainedRun, body: &BodyEpisodes, name: &str) -> Vec<MovingCharacter> {
    let mut env = body.open(run.excerpt.episode as u32);
    let model = env.task().model().clone();
    let driver = run.task.driver(&run.checkpoint.policy);
    let whole = record(&mut env, &*driver, name, |_, _| {});
    let frames = whole.frames.min(run.excerpt.frames(whole.rate));
    let motion = MotionClip {
        frames,
        q: whole.q[..frames * model.nq()].to_vec(),
        v: whole.v[..frames * model.nv()].to_vec(),
        ..whole
    };
    let trees = 0..model.trees.len();
    trees
        .map(|tree| MovingCharacter::of_tree(&model, tree, &motion))
        .collect()
}
