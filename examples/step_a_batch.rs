//! A batch of environments without learning: characters that ask for anything, and some that ask for the way.
//!
//! You learn how environments are opened, observed and stepped, and in what form a step comes back.
//!
//! `cargo run --release --no-default-features --features train --example step_a_batch`

use footwork::prelude::*;
use footwork::rl::rollout::Rollout;
use footwork::train::controller::{Controller, Scripted};
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};
use std::sync::Arc;

const ENVS: usize = 256;
/// Steps to play, a fifth of a second each.
const STEPS: usize = 200;

fn main() -> anyhow::Result<()> {
    let (clips, roles) = synthetic::perform(1, 4.0);
    let database = Arc::new(Database::build(&clips, roles, Weights::PAPER)?);
    let matcher = Arc::new(MotionMatcher::new(database.clone()));

    let mut random = SmallRng::seed_from_u64(1);
    run("random", &matcher, |observation, spec| {
        let rows = observation.len() / spec.observation.dim();
        let actions = (0..rows * spec.action).map(|_| random.random_range(-2.0..2.0));
        Ok(actions.collect())
    })?;
    // Straight to the target, at 2 m/s.
    let scripted = Scripted {
        database: &database,
        speed: 2.0,
    };
    run("scripted", &matcher, |observation, spec| {
        scripted.act(observation, spec.observation.dim())
    })
}

/// Plays a rollout of all environments, whose actions `act` makes of their observations, row by row.
fn run(
    name: &str,
    matcher: &Arc<MotionMatcher>,
    mut act: impl FnMut(&[f32], &EnvSpec) -> anyhow::Result<Vec<f32>>,
) -> anyhow::Result<()> {
    let config = EnvConfig {
        task: LocomotionTask::Plane(Plane::default()),
        envs: ENVS,
        seed: 1,
        level: 0,
    };
    let mut env = CpuLocomotion::new(matcher.clone(), &config);
    let spec = *env.spec();
    // The columns of a rollout: what was observed, done and rewarded in every step of every environment.
    let mut rollout = Rollout::new(&Device::Cpu, &spec, STEPS, 1);
    for step in 0..STEPS {
        rollout.observe(&mut env, step);
        let seen = spec.rows() * spec.observation.dim();
        let actions = act(&rollout.observation.host()[step * seen..][..seen], &spec)?;
        let done = spec.rows() * spec.action;
        rollout.action.host_mut()[step * done..][..done].copy_from_slice(&actions);
        // An episode that ends begins anew in the same step.
        rollout.step(&mut env, step);
    }
    let reward: f32 = rollout.reward.host().iter().sum();
    let ended = |how: u32| {
        let all = rollout.termination.host().iter();
        all.filter(|&&end| end == how).count()
    };
    println!(
        "{name}: reward {:.2} a step, {} targets reached, {} episodes truncated",
        reward / (STEPS * ENVS) as f32,
        ended(termination::SUCCESS),
        ended(termination::TRUNCATED)
    );
    Ok(())
}
