//! Who the learner plays against.

use crate::nn::Policy;
use crate::rl::strides::Strides;

/// Somebody to play against, who learns no more.
#[derive(Clone)]
pub enum Opponent {
    /// Follows a rule that nobody had to learn.
    Scripted(Strides),
    /// Draws from a policy's Gaussian, as the policy did while it learned.
    Frozen(Box<Policy>),
}

impl Opponent {
    /// Who repeats an action, whatever it sees.
    pub fn repeating(action: Vec<f32>) -> Opponent {
        Opponent::Scripted(Strides::one(action))
    }

    /// The policy, if it has one.
    pub fn policy(&self) -> Option<&Policy> {
        match self {
            Opponent::Scripted(_) => None,
            Opponent::Frozen(policy) => Some(policy),
        }
    }

    /// The rule, if it follows one.
    pub fn script(&self) -> Option<&Strides> {
        match self {
            Opponent::Scripted(strides) => Some(strides),
            Opponent::Frozen(_) => None,
        }
    }
}
