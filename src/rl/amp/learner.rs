//! PPO whose agents are rewarded for their style.

use super::{Amp, Discriminator, SkillRewards};
use crate::container::{Section, SectionError};
use crate::env::{Demonstrations, EnvBatch};
use crate::gpu::Device;
use crate::nn::Policy;
use crate::rl::gae::RewardSource;
use crate::rl::ppo::{Diversity, Ppo, PpoLearner};
use crate::rl::task_weight::TaskWeight;
use crate::rl::{Algorithm, Iteration};
use anyhow::{Result, bail};
use std::sync::Arc;
use std::time::Instant;

/// PPO with a discriminator: one more reward before the advantages, one more network that learns.
pub struct AmpLearner {
    ppo: PpoLearner,
    discriminator: Discriminator,
}

impl AmpLearner {
    /// A learner for the environments of a training, whose agents are to move as in the demonstrations; and
    /// differently under different latents, if the environments have any.
    ///
    /// # Errors
    /// A network does not fit the observation, or the device.
    pub fn new(
        ppo: &Ppo,
        amp: &Amp,
        skills: &SkillRewards,
        demonstrations: &Arc<Demonstrations>,
        envs: &EnvBatch,
        device: &Device,
        seed: u32,
    ) -> Result<Self> {
        let rewards = [
            (RewardSource::Task, amp.task_weight),
            (RewardSource::Style, amp.style_weight),
            (RewardSource::Skill, skills.weight),
        ];
        let rewards: Vec<_> = rewards
            .into_iter()
            .filter(|(_, weight)| *weight > 0.0)
            .collect();
        let samples = ppo.rollout_length * envs.spec().rows();
        let latents = skills.latents;
        // An environment alone has no other latent beside it.
        let paired = envs.parts.iter().all(|part| part.spec().rows() > 1);
        let diversity = Diversity {
            latent: latents.dim(),
            weight: if paired { skills.diversity } else { 0.0 },
        };
        let learner = PpoLearner::with_rewards(ppo, envs, device, seed, &rewards)?;
        Ok(AmpLearner {
            ppo: learner.with_diversity(diversity),
            discriminator: Discriminator::new(
                amp,
                latents,
                demonstrations,
                device,
                &envs.ranks,
                samples,
                seed,
            )?,
        })
    }

    /// Weighs the rewards of task and style by a rule, if there are both.
    pub fn with_task_weight(mut self, weight: TaskWeight) -> Self {
        self.ppo = self.ppo.with_task_weight(weight);
        self
    }
}

impl Algorithm for AmpLearner {
    fn iterate(&mut self, envs: &mut EnvBatch, steps: u64) -> Result<Iteration> {
        let begin = Instant::now();
        let [_, env_s] = self.ppo.collect(envs)?;
        self.discriminator.reward(&mut self.ppo.rollouts);
        self.ppo.estimate()?;
        let policy_s = begin.elapsed().as_secs_f64() - env_s;
        self.ppo.learn()?;
        self.discriminator.learn()?;
        let mut iteration = self.ppo.conclude(envs, steps, begin, [policy_s, env_s])?;
        let style = iteration.loss("style_reward").unwrap_or(0.0);
        iteration.losses.extend(self.discriminator.conclude(style)?);
        match iteration
            .losses
            .iter()
            .find(|(_, value)| !value.is_finite())
        {
            None => Ok(iteration),
            Some((name, value)) => bail!(
                "learning diverged: the {} is {value}; checkpoints are from before it, if one was due. Try a \
                 lower amp.learning_rate",
                name.replace('_', " ")
            ),
        }
    }

    fn policy(&self) -> Result<Policy> {
        self.ppo.policy()
    }

    fn start_from(&mut self, policy: &Policy, section: &mut Section) -> Result<(), SectionError> {
        self.ppo.start_from(policy, section)?;
        let mut own = section.take_section("discriminator");
        // What learned without a discriminator goes on with a new one.
        match own.is_empty() {
            true => Ok(()),
            false => self.discriminator.load(&mut own),
        }
    }

    fn save(&self, to: &mut Section) -> Result<()> {
        let mut own = Section::default();
        self.discriminator.save(&mut own)?;
        to.put_section("discriminator", own);
        self.ppo.save(to)
    }

    fn load(&mut self, from: &mut Section, policy: &Policy) -> Result<(), SectionError> {
        self.discriminator
            .load(&mut from.take_section("discriminator"))?;
        self.ppo.load(from, policy)
    }
}
