//! Lets the policy act for a while and remembers what learning needs.

use super::ppo::Ppo;
use crate::nn::policy::Policy;
use super::value_normalizer::Scale;
use crate::gpu::Device;
use crate::env::locomotion::{Batch, Values, World};
use anyhow::Result;
use burn::tensor::Tensor;
use rayon::prelude::*;
use std::time::Instant;

/// One rollout, `[horizon * envs]` rows: part after part of the batch, each time-major.
pub struct Rollout {
    pub observation: Tensor<2>,
    pub action: Tensor<2>,
    /// The policy's mean when it acted.
    pub mean: Tensor<2>,
    pub log_prob: Tensor<1>,
    /// The critic's normalised value.
    pub value: Tensor<1>,
    /// In units of reward.
    pub advantage: Tensor<1>,
    pub target: Tensor<1>,
    /// Logarithm of the standard deviation the actions were drawn with.
    pub log_std: Tensor<1>,
    /// Seconds spent in the networks.
    pub act_s: f64,
    /// Seconds spent in the worlds.
    pub simulate_s: f64,
}

impl Rollout {
    /// One after another.
    fn join(mut parts: Vec<Rollout>) -> Rollout {
        if parts.len() == 1 {
            return parts.remove(0);
        }
        fn joined<const D: usize>(parts: &[Rollout], of: fn(&Rollout) -> &Tensor<D>) -> Tensor<D> {
            Tensor::cat(parts.iter().map(|part| of(part).clone()).collect(), 0)
        }
        let seconds = |of: fn(&Rollout) -> f64| parts.iter().map(of).sum();
        Rollout {
            observation: joined(&parts, |part| &part.observation),
            action: joined(&parts, |part| &part.action),
            mean: joined(&parts, |part| &part.mean),
            log_prob: joined(&parts, |part| &part.log_prob),
            value: joined(&parts, |part| &part.value),
            advantage: joined(&parts, |part| &part.advantage),
            target: joined(&parts, |part| &part.target),
            log_std: parts[0].log_std.clone(),
            act_s: seconds(|part| part.act_s),
            simulate_s: seconds(|part| part.simulate_s),
        }
    }
}

/// Steps all worlds `horizon` times, the batch's parts one after another or at once. Their seconds
/// are shares of the time that all took together.
///
/// # Errors
/// The device was lost.
pub fn collect(
    batch: &mut Batch,
    policy: &Policy,
    scale: &Scale,
    config: &Ppo,
    device: &Device,
) -> Result<Rollout> {
    let begin = Instant::now();
    let parts = batch.parts.par_iter_mut();
    let parts = parts.map(|world| play(&mut **world, policy, scale, config, device));
    let mut rollout = Rollout::join(parts.collect::<Result<_>>()?);
    let share = begin.elapsed().as_secs_f64() / (rollout.act_s + rollout.simulate_s);
    rollout.act_s *= share;
    rollout.simulate_s *= share;
    Ok(rollout)
}

/// Steps worlds `horizon` times.
fn play(
    world: &mut dyn World,
    policy: &Policy,
    scale: &Scale,
    config: &Ppo,
    device: &Device,
) -> Result<Rollout> {
    let (mut observations, mut actions, mut means, mut log_probs) =
        (vec![], vec![], vec![], vec![]);
    let mut acting_share = 0.0;
    let begin = Instant::now();
    for step in 0..config.rollout_length {
        // A GPU only queues what it is asked for; the first step of a rollout waits for it, to
        // see how the time of all divides.
        let clock = || -> Result<Instant> {
            if step == 0 {
                device.sync()?;
            }
            Ok(Instant::now())
        };
        let start = clock()?;
        let observation = world.observe();
        let seen = clock()?;
        let mean = policy.mean(observation.clone());
        let (action, log_prob) = world.act(mean.clone(), policy.log_std.clone());
        let acted = clock()?;
        world.step(action.clone());
        if step == 0 {
            let total = (clock()? - start).as_secs_f64();
            acting_share = (acted - seen).as_secs_f64() / total.max(1e-9);
        }
        device.pace()?;
        observations.push(observation);
        actions.push(action);
        means.push(mean);
        log_probs.push(log_prob);
    }
    device.sync()?;
    let stepped = Instant::now();
    let observation = Tensor::cat(observations, 0);
    // The critic does not act: one large batch is quicker than many small ones.
    let value = policy.value(observation.clone());
    let values = Values {
        observed: value.clone(),
        next: policy.value(world.observe()),
        last: policy.value(world.last()),
        scale: scale.mean_and_deviation(),
    };
    let (advantage, target) = world.judge(values, config.gamma, config.lambda);
    device.sync()?;
    let stepping = (stepped - begin).as_secs_f64();
    Ok(Rollout {
        observation,
        action: Tensor::cat(actions, 0),
        mean: Tensor::cat(means, 0),
        log_prob: Tensor::cat(log_probs, 0),
        value,
        advantage,
        target,
        log_std: policy.log_std.clone(),
        act_s: stepping * acting_share + stepped.elapsed().as_secs_f64(),
        simulate_s: stepping * (1.0 - acting_share),
    })
}
