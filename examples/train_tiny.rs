//! A policy that walks to targets, learned on the CPU in a second or two.
//!
//! You learn the loop of a training: a learner plays a rollout of all environments and improves, again and again.
//! Runs with checkpoints, curves and evaluations are `footwork train plane`, or `footwork::train::trainer`.
//!
//! `cargo run --release --no-default-features --features train --example train_tiny`

use footwork::prelude::*;
use std::sync::Arc;

const UPDATES: u64 = 60;

fn main() -> anyhow::Result<()> {
    let (clips, roles) = synthetic::perform(1, 4.0);
    let database = Database::build(&clips, roles, Weights::PAPER)?;
    let matcher = Arc::new(MotionMatcher::new(Arc::new(database)));

    let ppo = Ppo::default();
    let config = EnvConfig {
        task: LocomotionTask::Plane(Plane::default()),
        envs: ppo.envs,
        seed: 1,
        level: 0,
    };
    let mut envs = config.open(&Device::Cpu, &matcher)?;
    let mut learner = PpoLearner::new(&ppo, &envs, &Device::Cpu, 1)?;
    for update in 0..UPDATES {
        let steps = update * ppo.batch() as u64;
        let iteration = learner.iterate(&mut envs, steps)?;
        if let (3, Some(success)) = (update % 4, iteration.stats.mean("successes")) {
            let bar = "#".repeat((50.0 * success) as usize);
            println!("{steps:>7} steps  {:>5.1} %  {bar}", 100.0 * success);
        }
    }

    // What is left is a policy: a function from an observation to the mean of an action.
    let policy = learner.policy()?;
    let observation = vec![0.0; policy.observation().dim()];
    println!("asks for {:.2?}", policy.mean(&observation));
    Ok(())
}
