//! Refuses choices that cannot work, whatever the task.

use super::{Config, ConfigError};
use crate::kernels::self_play::group_bouts::MAX_POLICIES;
use crate::rl::amp::{Amp, DiscriminatorLoss};
use crate::rl::ase::Ase;
use crate::rl::ppo::Ppo;
use crate::rl::self_play::SelfPlay;
use crate::rl::task_weight::WeightRule;
use std::fmt::Display;

impl Config {
    /// Refuses what cannot work, whatever the task.
    pub(in crate::train) fn check(&self) -> Result<(), ConfigError> {
        const LONG: u64 = 1_000_000_000_000_000;
        within("steps", self.steps, 1, LONG)?;
        within("evaluate_every", self.evaluate_every, 1, LONG)?;
        within("checkpoint_every", self.checkpoint_every, 1, LONG)?;
        within("film_share", self.film_share, 0.0, 1000.0)?;
        if let Some(seconds) = self.max_time_s {
            within("max_time_s", seconds, 0.001, 1e9)?;
        }
        if let Some(success) = self.stop_at_success {
            within("stop_at_success", success, 0.01, 1.0)?;
        }
        if let Some(unit) = self.unit_m {
            within("unit_m", f64::from(unit), 1e-6, 1e3)?;
        }
        check_ppo(&self.ppo)?;
        self.amp.as_ref().map_or(Ok(()), check_amp)?;
        self.ase.as_ref().map_or(Ok(()), check_ase)?;
        self.self_play.as_ref().map_or(Ok(()), check_self_play)?;
        self.check_task_weight()
    }

    /// Refuses a rule for the weights of rewards that cannot be weighed by it.
    fn check_task_weight(&self) -> Result<(), ConfigError> {
        let chosen = &self.task_weight;
        within(
            "task_weight.style_reference",
            chosen.style_reference,
            0.0,
            1e3,
        )?;
        if chosen.rule == WeightRule::Fixed || self.skills.is_some() {
            return Ok(());
        }
        match &self.amp {
            Some(amp) if amp.task_weight > 0.0 => self.check_style_rewards(amp.loss),
            _ => Err(no_rule(format!(
                "it weighs the rewards of task and style, and the task `{}` has but one of them",
                self.task.name
            ))),
        }
    }

    /// Refuses a rule for the weights that style rewards of a discriminator with this loss do not allow.
    pub(in crate::train) fn check_style_rewards(
        &self,
        loss: DiscriminatorLoss,
    ) -> Result<(), ConfigError> {
        match (self.task_weight.rule, loss) {
            (WeightRule::Pd, DiscriminatorLoss::Hinge) => Err(no_rule(
                "it compares style rewards by their ratio, and those of amp.loss = \"hinge\" may be negative".into(),
            )),
            _ => Ok(()),
        }
    }
}

fn no_rule(why: String) -> ConfigError {
    ConfigError::Value {
        key: "task_weight.rule",
        value: "pd".into(),
        why,
    }
}

/// Refuses a number out of its range, ends included; NaN is in none.
pub(in crate::train) fn within<N: PartialOrd + Display>(
    key: &'static str,
    value: N,
    least: N,
    most: N,
) -> Result<(), ConfigError> {
    if least <= value && value <= most {
        return Ok(());
    }
    Err(ConfigError::Value {
        key,
        value: value.to_string(),
        why: format!("it must lie between {least} and {most}"),
    })
}

fn check_ppo(ppo: &Ppo) -> Result<(), ConfigError> {
    within("ppo.envs", ppo.envs, 1, 1 << 20)?;
    within("ppo.rollout_length", ppo.rollout_length, 1, 10_000)?;
    within("ppo.envs times ppo.rollout_length", ppo.batch(), 1, 1 << 23)?;
    within("ppo.epochs", ppo.epochs, 1, 1000)?;
    within("ppo.minibatch_size", ppo.minibatch_size, 1, 1 << 23)?;
    within("ppo.learning_rate", ppo.learning_rate, 1e-9, 1.0)?;
    within("ppo.final_lr_fraction", ppo.final_lr_fraction, 0.0, 1.0)?;
    within(
        "ppo.critic_learning_rate",
        ppo.critic_learning_rate,
        0.0,
        1.0,
    )?;
    within("ppo.desired_kl", ppo.desired_kl, 0.0, 100.0)?;
    within("ppo.gamma", ppo.gamma, 0.0, 1.0)?;
    within("ppo.lambda", ppo.lambda, 0.0, 1.0)?;
    within("ppo.clip", ppo.clip, 1e-3, 100.0)?;
    within("ppo.value_clip", ppo.value_clip, 0.0, 1e6)?;
    within("ppo.value_coefficient", ppo.value_coefficient, 0.0, 1e3)?;
    within("ppo.entropy_coefficient", ppo.entropy_coefficient, 0.0, 1e3)?;
    within("ppo.kl_coefficient", ppo.kl_coefficient, 0.0, 1e3)?;
    within("ppo.kl_penalty_target", ppo.kl_penalty_target, 1e-6, 100.0)?;
    within("ppo.max_grad_norm", ppo.max_grad_norm, 0.0, 1e6)?;
    within("ppo.init_log_std", ppo.init_log_std, -10.0, 2.0)
}

pub(in crate::train) fn check_amp(amp: &Amp) -> Result<(), ConfigError> {
    within("amp.heads", amp.heads, 1, 1024)?;
    within("amp.steps", amp.steps, 1, 1000)?;
    within("amp.minibatch_size", amp.minibatch_size, 2, 1 << 20)?;
    within("amp.learning_rate", amp.learning_rate, 1e-9, 1.0)?;
    within("amp.max_grad_norm", amp.max_grad_norm, 0.0, 1e6)?;
    within("amp.gradient_penalty", amp.gradient_penalty, 0.0, 1e6)?;
    within("amp.logit_decay", amp.logit_decay, 0.0, 1e3)?;
    within("amp.replay_capacity", amp.replay_capacity, 1, 1 << 22)?;
    within("amp.replay_per_update", amp.replay_per_update, 1, 1 << 22)?;
    within("amp.style_weight", amp.style_weight, 1e-6, 1e3)?;
    within("amp.task_weight", amp.task_weight, 0.0, 1e3)
}

pub(in crate::train) fn check_ase(ase: &Ase) -> Result<(), ConfigError> {
    let [least, most] = ase.kept_steps;
    within("ase.latent", ase.latent, 2, 256)?;
    within("ase.kept_steps", most, 1, 10_000)?;
    within("the first of ase.kept_steps", least, 1, most)?;
    within("ase.skill_weight", ase.skill_weight, 0.0, 1e3)?;
    within("ase.diversity", ase.diversity, 0.0, 1e3)?;
    within("ase.spread", ase.spread, 0.0, 10.0)
}

fn check_self_play(chosen: &SelfPlay) -> Result<(), ConfigError> {
    within("self_play.pool", chosen.pool, 1, MAX_POLICIES)?;
    within("self_play.scripted", chosen.scripted, 0.0, 1.0)?;
    within("self_play.win_rate", chosen.win_rate, 0.0, 1.0)?;
    within("self_play.games", chosen.games, 0, 1_000_000_000)?;
    within("self_play.updates", chosen.updates, 0, 1_000_000_000)?;
    within("self_play.decay", chosen.decay, 0.0, 1.0)
}
