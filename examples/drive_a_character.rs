//! A trained policy in a loop of your own: a target that moves, and the whole body at every frame.
//!
//! You learn to step one character: every fifth of a second the policy chooses what to play, and at every frame a
//! player makes a pose of it, with feet that stand where they stand.
//!
//! `cargo run --release --no-default-features --features train --example drive_a_character [-- CHECKPOINT]`
//!
//! Without a checkpoint, such as `runs/plane-1/checkpoints/last.ckpt` of a run on synthetic motion, it trains first.

use footwork::motion::RATE;
use footwork::motion::features::FRAMES_PER_STEP;
use footwork::playback::player::{Feet, Style};
use footwork::prelude::*;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::data::SYNTHETIC_SEED;
use footwork::train::rendered_frames::standing;
use std::path::Path;
use std::sync::Arc;

const SECONDS: usize = 20;
/// The target goes around a circle of this radius, m, once in so many seconds.
const RADIUS: f32 = 4.0;
const ROUND: f32 = 20.0;

fn main() -> anyhow::Result<()> {
    let checkpoint = std::env::args_os().nth(1);
    // A policy needs the motion that it was trained with.
    let minutes = checkpoint.as_ref().map_or(4.0, |_| synthetic::MINUTES);
    let (clips, roles) = synthetic::perform(SYNTHETIC_SEED, minutes);
    let database = Arc::new(Database::build(&clips, roles, Weights::PAPER)?);
    let matcher = Arc::new(MotionMatcher::new(database.clone()));
    let policy = match checkpoint {
        Some(path) => {
            let (spec, motion) = (plane(1).spec(), database.fingerprint.into());
            Checkpoint::load_for(Path::new(&path), "plane", &spec, motion)?.policy
        }
        None => train(&matcher)?,
    };

    let mut env = CpuLocomotion::new(matcher, &plane(1));
    let mut shown = standing(&env, 0);
    let feet = Arc::new(Feet::of(&database));
    let mut player = Player::new(database.clone(), feet, Style::BEST, shown);
    for frame in 0..SECONDS * RATE as usize {
        let angle = std::f32::consts::TAU * frame as f32 / RATE / ROUND;
        let target = [RADIUS * angle.sin(), RADIUS * angle.cos()];
        if frame % FRAMES_PER_STEP == 0 {
            env.set_target(0, target);
            // Where the character is now, in the frame that the policy has found to go on with.
            let at = standing(&env, 0);
            env.step_without_reset(&policy.mean(&env.observation()));
            let matched = database.candidates[env.matched[0] as usize] as usize;
            shown = PlacedFrame {
                frame: matched,
                ..at
            };
        }
        shown = shown.on(&database, 1);
        let pose = player.next(shown);
        // World positions (m) and rotations of all joints: what an engine skins.
        let (positions, _rotations) = pose.world(&database.skeleton);
        if frame % RATE as usize == 0 {
            let [hips, foot] = [roles.hips, roles.left_foot].map(|joint| positions[joint]);
            let away = (target[0] - hips.x).hypot(target[1] - hips.z);
            println!("hips at {hips:5.2}, left foot at {foot:5.2}, {away:.1} m from the target");
        }
    }
    Ok(())
}

/// So many characters that are never done with their target.
fn plane(envs: usize) -> EnvConfig {
    let task = Plane {
        success_radius: 0.0,
        ..Plane::default()
    };
    EnvConfig {
        task: LocomotionTask::Plane(task),
        envs,
        seed: 1,
        level: 0,
    }
}

/// The training of `train_tiny.rs`.
fn train(matcher: &Arc<MotionMatcher>) -> anyhow::Result<Policy> {
    let ppo = Ppo::default();
    let mut envs = EnvConfig {
        task: LocomotionTask::Plane(Plane::default()),
        ..plane(ppo.envs)
    }
    .open(&Device::Cpu, matcher)?;
    let mut learner = PpoLearner::new(&ppo, &envs, &Device::Cpu, 1)?;
    for update in 0..100 {
        learner.iterate(&mut envs, update * ppo.batch() as u64)?;
    }
    learner.policy()
}
