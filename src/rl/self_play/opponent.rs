//! Who the learner plays against.

use crate::kernels::learn::sample_action;
use crate::nn::Policy;
use std::sync::Arc;

/// Actions `[rows][action]` for observations `[rows][observation]`.
pub type Rule = dyn Fn(&[f32]) -> Vec<f32> + Send + Sync;

/// Somebody to play against, who learns no more.
#[derive(Clone)]
pub enum Opponent {
    /// Follows a rule that nobody had to learn.
    Scripted(Arc<Rule>),
    /// Draws from a policy's Gaussian, as the policy did while it learned.
    Frozen(Box<Policy>),
}

impl Opponent {
    /// Who repeats an action, whatever it sees of so many numbers.
    pub fn repeating(action: Vec<f32>, observation: usize) -> Opponent {
        let rows = move |seen: &[f32]| seen.len() / observation;
        Opponent::Scripted(Arc::new(move |seen| action.repeat(rows(seen))))
    }

    /// Actions `[rows][action]` for observations `[rows][observation]`, in the environments of these numbers in the
    /// whole batch: what is drawn depends on them, `seed` and `step_counter` alone.
    pub fn act(&self, observation: &[f32], envs: &[u32], seed: u32, step_counter: u32) -> Vec<f32> {
        let policy = match self {
            Opponent::Scripted(rule) => return rule(observation),
            Opponent::Frozen(policy) => policy,
        };
        let mean = policy.mean(observation);
        let mut action = vec![0.0; mean.len()];
        let mut log_prob = vec![0.0; envs.len()];
        for (row, &env) in envs.iter().enumerate() {
            let params = sample_action::Params {
                rows: 1,
                action: policy.action() as u32,
                row: row as u32,
                first: env,
                seed,
                step_counter,
            };
            let log_std = policy.log_std();
            sample_action::twin(&mean, log_std, &mut action, &mut log_prob, &params);
        }
        action
    }
}
