//! Gradient steps on the CPU.

use super::gradient;
use super::loss::{Actor, ActorSums, critic};
use crate::motion::features::TRAJECTORY_DIM;
use crate::nn::adam;
use crate::rl::ppo::loss::{LOSSES, SCALARS, Terms};
use crate::nn::network::Shape;

/// Parameters on their way down, and [`adam::Adam`]'s moments.
pub struct Descent {
    pub parameters: Vec<f32>,
    pub first: Vec<f32>,
    pub second: Vec<f32>,
    pub steps: u64,
    pub rate: f64,
    pub max_norm: f64,
}

impl Descent {
    /// One step on a minibatch of packed samples. Returns its summed losses: surrogate, value loss,
    /// entropy, KL divergence, samples that left the clip range.
    pub fn step(
        &mut self,
        shape: &Shape,
        rows: &[&[f32]],
        old_log_std: &[f32],
        terms: &Terms,
    ) -> [f32; LOSSES] {
        let flat = &self.parameters;
        let actor = Actor {
            terms,
            log_std: &flat[shape.log_std..],
            old_log_std,
        };
        let width = rows.first().map_or(0, |row| row.len()) - 2 * TRAJECTORY_DIM - SCALARS;
        let judge_actor = |rows: &[&[f32]], means: &mut [f32], sums: &mut ActorSums| {
            actor.judge(rows, means, sums);
        };
        let judge_critic = |rows: &[&[f32]], values: &mut [f32], sum: &mut f32| {
            critic(terms, rows, values, sum);
        };
        let ((mut total, of_actor), (of_critic, values)) = rayon::join(
            || {
                gradient(
                    &shape.actor,
                    flat,
                    rows,
                    width,
                    ActorSums::default,
                    judge_actor,
                )
            },
            || gradient(&shape.critic, flat, rows, width, f32::default, judge_critic),
        );
        total.extend(of_critic);
        let sums = ActorSums::total(&of_actor);
        total.extend(sums.log_std);
        let entropy = actor.entropy() * rows.len() as f32;
        self.steps += 1;
        adam::step(
            &mut self.parameters,
            &total,
            &mut self.first,
            &mut self.second,
            self.steps,
            self.rate,
            self.max_norm,
        );
        [
            sums.surrogate,
            values.iter().sum(),
            entropy,
            sums.kl,
            sums.left,
        ]
    }
}
