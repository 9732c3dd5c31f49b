//! Who the learner plays against.

use crate::container::{Section, SectionError};
use crate::kernels::learn::sample_action;
use crate::nn::Policy;
use anyhow::Result;

/// Somebody to play against, who learns no more.
#[derive(Clone)]
pub enum Opponent {
    /// Repeats an action, `[action]`, whatever it observes.
    Scripted(Vec<f32>),
    /// Draws from a policy's Gaussian, as the policy did while it learned.
    Frozen(Box<Policy>),
}

impl Opponent {
    /// Who repeats the action at rest of environments with actions of so many numbers: see
    /// [`VecEnv::rest_action`](crate::env::VecEnv::rest_action).
    pub fn at_rest(mut rest: Vec<f32>, action: usize) -> Opponent {
        rest.resize(action, 0.0);
        Opponent::Scripted(rest)
    }

    /// Actions `[rows][action]` for observations `[rows][observation]`, in the environments of these numbers in the
    /// whole batch: what is drawn depends on them, `seed` and `step_counter` alone.
    pub fn act(&self, observation: &[f32], envs: &[u32], seed: u32, step_counter: u32) -> Vec<f32> {
        let policy = match self {
            Opponent::Scripted(action) => return action.repeat(envs.len()),
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

    /// Saves all of it.
    ///
    /// # Errors
    /// None: it is in host memory.
    pub fn save(&self, to: &mut Section) -> Result<()> {
        match self {
            Opponent::Scripted(action) => {
                to.put("repeated", action.len());
                to.put_array("action", action);
                Ok(())
            }
            Opponent::Frozen(policy) => policy.save(to),
        }
    }

    /// Reads what [`Opponent::save`] saved, of somebody who acts on so many numbers by so many.
    ///
    /// # Errors
    /// It is not that, or of environments with other dimensions.
    pub fn load(
        from: &mut Section,
        observation: usize,
        action: usize,
    ) -> Result<Self, SectionError> {
        if let Ok(repeated) = from.get::<usize>("repeated") {
            let own = from.take_finite("action", repeated)?;
            return match repeated == action {
                true => Ok(Opponent::Scripted(own)),
                false => Err(other_dimensions()),
            };
        }
        let policy = Policy::load(from)?;
        match (policy.observation().dim(), policy.action()) == (observation, action) {
            true => Ok(Opponent::Frozen(Box::new(policy))),
            false => Err(other_dimensions()),
        }
    }
}

fn other_dimensions() -> SectionError {
    SectionError("an opponent is of environments with other dimensions".into())
}
