//! The policy at work: it acts, and learns from what came of it.

use super::Ppo;
use super::adopt_actor::adopt_actor;
use super::batch::Batch;
use super::loss::{Diversity, LossCoefficients, PpoLoss, SUMS};
use crate::container::{Section, SectionError};
use crate::env::{EnvBatch, EnvSpec, Stats, VecEnv};
use crate::gpu::{Array, Device};
use crate::kernels::learn::rollout_moments::scale;
use crate::kernels::learn::{adapt_lr, sample_action};
use crate::kernels::rng::{index_below, permutation, random4};
use crate::nn::{ActorCritic, Adam, Engine, Policy, RunningMeanStd, rows};
use crate::ranks::Ranks;
use crate::rl::gae::{Bootstrap, RewardSource, gae};
use crate::rl::rollout::Rollout;
use crate::rl::sample_action::sample_action;
use crate::rl::task_weight::TaskWeight;
use crate::rl::value_normalizer::ValueNormalizer;
use crate::rl::{Algorithm, Iteration};
use anyhow::{Result, bail};
use rayon::prelude::*;
use std::ops::Range;
use std::time::Instant;

/// First random stream of the shuffles.
const SHUFFLE: u32 = 0x5348_5546;
/// Random stream of the pairs of latents.
const OTHER_LATENT: u32 = 0x4f54_4845;
/// Factor by which learning rate and KL penalty are adapted.
const LR_FACTOR: f64 = 1.5;
/// Range of an adapted learning rate.
const LR_RANGE: [f64; 2] = [1e-5, 1e-2];

/// Range of a learning rate that is adapted before each minibatch.
const MINIBATCH_LR_RANGE: [f64; 2] = [2e-5, 3e-3];
/// Updates in which only the critic learns, of a policy that comes from another training: the first
/// advantages would be noise, which drives it away from what it knows.
const CRITIC_ALONE: u64 = 20;
/// Index of the KL divergence in the objective's sums.
const KL: usize = 3;

/// PPO with separate networks for actor and critic.
pub struct PpoLearner {
    config: Ppo,
    device: Device,
    ranks: Ranks,
    spec: EnvSpec,
    networks: ActorCritic,
    engine: Engine,
    parameters: Array,
    /// Logarithms of the standard deviations while the rollouts are played.
    log_std: Array,
    adam: Adam,
    value_normalizer: ValueNormalizer,
    observation_normalizer: Option<RunningMeanStd>,
    /// Where the streams of rewards come from.
    sources: Vec<RewardSource>,
    diversity: Diversity,
    /// Latents of the present rollouts as they are drawn, `[samples][latent]` each, if they are to lead to different
    /// actions.
    latents: Vec<Array>,
    /// What decides on their weights, if the style is one of them.
    task_weight: Option<TaskWeight>,
    /// Rollouts of the present iteration, one for each part of the environments.
    pub(in crate::rl) rollouts: Vec<Rollout>,
    gradient: Array,
    sums: Array,
    learning_rate: f64,
    /// Weight of the KL penalty, if there is one.
    kl_coefficient: f64,
    updates: u64,
    /// The first update in which the actor learns.
    actor_from: u64,
    seed: u32,
}

/// Numbers of the actor and the critic among the engine's networks.
const ACTOR: usize = 0;
const CRITIC: usize = 1;

/// The optimiser of both networks, with their learning rates.
fn adam(config: &Ppo, networks: &ActorCritic, device: &Device) -> Adam {
    let adam = Adam::new(device, networks.parameters());
    match config.critic_learning_rate {
        0.0 => adam,
        rate => adam.with_second_rate(networks.critic.span(), rate / config.learning_rate),
    }
}

impl PpoLearner {
    /// A learner for the environments of a training and their rewards. Its first actions are near their
    /// rest action.
    ///
    /// # Errors
    /// The network does not fit the observation, or the device.
    pub fn new(config: &Ppo, envs: &EnvBatch, device: &Device, seed: u32) -> Result<Self> {
        Self::with_rewards(config, envs, device, seed, &[(RewardSource::Task, 1.0)])
    }

    /// A learner for rewards from several sources, whose advantages are normalised apart and added by their weights.
    ///
    /// # Errors
    /// The network does not fit the observation, or the device.
    pub fn with_rewards(
        config: &Ppo,
        envs: &EnvBatch,
        device: &Device,
        seed: u32,
        rewards: &[(RewardSource, f32)],
    ) -> Result<Self> {
        let spec = &envs.spec();
        let (sources, weights): (Vec<RewardSource>, Vec<f32>) = rewards.iter().copied().unzip();
        let values = sources.len();
        let networks = ActorCritic::new(&config.network, &spec.observation, spec.action, values)?;
        let parameters = networks.parameters();
        let ranks = &envs.ranks;
        let config = &Ppo {
            minibatch_size: ranks.portion(config.minibatch_size),
            ..config.clone()
        };
        let samples = config.rollout_length * spec.rows();
        let engine = Engine::new(
            device,
            networks.networks(),
            parameters,
            spec.action + SUMS,
            samples,
            config.minibatch_size.min(samples),
        )?;
        let initial = networks.init(seed, config.init_log_std, &envs.rest_action());
        let normalizer = || RunningMeanStd::new(device, spec.observation.dim());
        Ok(PpoLearner {
            parameters: Array::from_slice(device, &initial),
            log_std: Array::zeroed(device, spec.action),
            adam: adam(config, &networks, device),
            value_normalizer: ValueNormalizer::new(device, ranks, &weights),
            observation_normalizer: config.normalize_observations.then(normalizer),
            task_weight: sources
                .contains(&RewardSource::Style)
                .then(TaskWeight::fixed),
            sources,
            diversity: Diversity::default(),
            latents: Vec::new(),
            rollouts: Vec::new(),
            gradient: Array::zeroed(device, parameters),
            sums: Array::zeroed(device, SUMS),
            learning_rate: config.learning_rate,
            kl_coefficient: config.kl_coefficient,
            updates: 0,
            actor_from: 0,
            seed,
            config: config.clone(),
            device: device.clone(),
            ranks: ranks.clone(),
            spec: *spec,
            networks,
            engine,
        })
    }

    /// Asks for different actions under different latents, of which there are at least two in every part of the
    /// environments.
    pub fn with_diversity(self, diversity: Diversity) -> Self {
        PpoLearner { diversity, ..self }
    }

    /// Weighs the rewards of task and style by a rule, if there are both.
    pub fn with_task_weight(mut self, weight: TaskWeight) -> Self {
        let wanted = [RewardSource::Task, RewardSource::Style];
        if wanted.iter().all(|source| self.sources.contains(source)) {
            self.task_weight = Some(weight);
            self.set_weights();
        }
        self
    }

    /// Plays a rollout of all environments, the batch's parts one after another or at once. Returns
    /// the seconds spent in the networks and in the environments: fractions of the time that all
    /// took together.
    pub(in crate::rl) fn collect(&mut self, envs: &mut EnvBatch) -> Result<[f64; 2]> {
        let begin = Instant::now();
        let range = self.networks.log_std();
        self.log_std = self.parameters.copy(&self.device, range);
        if self.rollouts.is_empty() {
            let (device, steps) = (&self.device, self.config.rollout_length);
            let specs = envs.parts.iter().map(|part| *part.spec());
            self.rollouts = specs
                .map(|spec| Rollout::new(device, &spec, steps, self.sources.len()))
                .collect();
        }
        let mut rollouts = std::mem::take(&mut self.rollouts);
        let firsts: Vec<usize> = rollouts
            .iter()
            .scan(envs.first_row(), |next, part| {
                let first = *next;
                *next += part.spec.rows();
                Some(first)
            })
            .collect();
        let parts = envs.parts.par_iter_mut().zip(&mut rollouts).zip(firsts);
        let seconds: Result<Vec<[f64; 2]>> = parts
            .map(|((env, rollout), first)| self.play(&mut **env, rollout, first))
            .collect();
        let [policy_s, env_s] = seconds?
            .into_iter()
            .fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]]);
        self.rollouts = rollouts;
        let played_s = begin.elapsed().as_secs_f64();
        let fraction = env_s / (policy_s + env_s).max(1e-9);
        Ok([1.0 - fraction, fraction].map(|fraction| played_s * fraction))
    }

    /// Normalises the rollouts' observations, which are raw before, and fills in values, advantages and
    /// returns.
    pub(in crate::rl) fn estimate(&mut self) -> Result<()> {
        let mut rollouts = std::mem::take(&mut self.rollouts);
        let normalizer = self.observation_normalizer.clone();
        if let Some(running) = &mut self.observation_normalizer {
            for rollout in &rollouts {
                running.update_over(&self.ranks, &rollout.observation, rollout.samples())?;
            }
        }
        if self.diversity.width(self.spec.action) > 0 {
            let latents = rollouts.iter().map(|rollout| self.latents_of(rollout));
            self.latents = latents.collect();
        }
        rollouts
            .par_iter_mut()
            .for_each(|rollout| self.evaluate(rollout, normalizer.as_ref()));
        self.rollouts = rollouts;
        self.device.sync()
    }

    /// Plays a rollout of a part, whose first row has the number `first` among those of all ranks.
    fn play(&self, env: &mut dyn VecEnv, rollout: &mut Rollout, first: usize) -> Result<[f64; 2]> {
        let (rows, action) = (rollout.spec.rows(), self.spec.action);
        let begin = Instant::now();
        let mut policy_fraction = 0.0;
        let mut seen = Array::zeroed(&self.device, rows * self.spec.observation.dim());
        for step in 0..rollout.steps {
            // A GPU only queues what is requested; the first step of a rollout waits for it, to see
            // how the time of all divides.
            let clock = || -> Result<Instant> {
                if step == 0 {
                    self.device.sync()?;
                }
                Ok(Instant::now())
            };
            let start = clock()?;
            rollout.observe(env, step);
            let observed = clock()?;
            let (parameters, row) = (&self.parameters, step * rows);
            let mean = &mut rollout.mean;
            match &self.observation_normalizer {
                None => self.engine.forward(
                    ACTOR,
                    parameters,
                    &rollout.observation,
                    row,
                    rows,
                    mean,
                    row * action,
                ),
                Some(normalizer) => {
                    let at = row * self.spec.observation.dim();
                    normalizer.normalize(&rollout.observation, at, &mut seen, 0, rows);
                    let to = row * action;
                    self.engine
                        .forward(ACTOR, parameters, &seen, 0, rows, mean, to);
                }
            }
            let params = sample_action::Params {
                rows: rows as u32,
                action: action as u32,
                row: row as u32,
                first: first as u32,
                seed: self.seed,
                step_counter: (self.updates * rollout.steps as u64 + step as u64) as u32,
            };
            sample_action(&self.device, &self.log_std, rollout, &params);
            let acted = clock()?;
            rollout.step(env, step);
            if step == 0 {
                let total = (clock()? - start).as_secs_f64();
                policy_fraction = (acted - observed).as_secs_f64() / total.max(1e-9);
            }
            self.device.pace()?;
        }
        rollout.observe(env, rollout.steps);
        self.device.sync()?;
        let total = begin.elapsed().as_secs_f64();
        Ok([policy_fraction, 1.0 - policy_fraction].map(|fraction| total * fraction))
    }

    /// Normalises a rollout's observations and fills in values, advantages and returns. The critic
    /// does not act: one large batch is quicker than many small ones.
    fn evaluate(&self, rollout: &mut Rollout, normalizer: Option<&RunningMeanStd>) {
        let (rows, samples) = (rollout.spec.rows(), rollout.samples());
        let final_rows = rows * rollout.spec.final_steps(rollout.steps);
        if let Some(normalizer) = normalizer {
            normalizer.normalize_in_place(&mut rollout.observation, samples);
            normalizer.normalize_in_place(&mut rollout.next_observation, rows);
            normalizer.normalize_in_place(&mut rollout.final_observation, final_rows);
        }
        let value = |observation: &Array, count: usize, out: &mut Array, at: usize| {
            let parameters = &self.parameters;
            self.engine
                .forward(CRITIC, parameters, observation, 0, count, out, at);
        };
        let zeros = |len: usize| Array::zeroed(&self.device, len);
        let mut bootstrap = Bootstrap {
            next_value: zeros(rows * self.sources.len()),
            final_value: zeros(final_rows * self.sources.len()),
        };
        let values = &mut rollout.log_prob_and_value;
        // Behind the logarithms of the densities.
        value(&rollout.observation, samples, values, samples);
        value(
            &rollout.next_observation,
            rows,
            &mut bootstrap.next_value,
            0,
        );
        value(
            &rollout.final_observation,
            final_rows,
            &mut bootstrap.final_value,
            0,
        );
        let (gamma, lambda) = (self.config.gamma, self.config.lambda);
        let scale = self.value_normalizer.scale();
        let sources = &self.sources;
        gae(
            &self.device,
            rollout,
            &bootstrap,
            scale,
            sources,
            gamma,
            lambda,
        );
    }

    /// Takes gradient steps on the rollouts. The sums of the last epoch stay on the device.
    ///
    /// # Errors
    /// The device was lost.
    pub(in crate::rl) fn learn(&mut self) -> Result<()> {
        self.value_normalizer.update(&self.rollouts)?;
        let mut rollouts = std::mem::take(&mut self.rollouts);
        self.value_normalizer.normalize_advantages(&mut rollouts);
        let device = self.device.clone();
        let scale = self.value_normalizer.scale().clone();
        let mut batch = Batch::new(
            &device,
            &rollouts,
            scale,
            self.under_other_latents(&rollouts),
        );
        let samples = batch.samples();
        for epoch in 0..self.config.epochs {
            let stream = SHUFFLE + epoch as u32;
            batch.begin_epoch(permutation(self.seed, self.updates as u32, stream, samples));
            self.sums = Array::zeroed(&device, SUMS);
            for start in (0..samples).step_by(self.config.minibatch_size) {
                let end = samples.min(start + self.config.minibatch_size);
                self.step(&batch, start..end)?;
            }
        }
        self.updates += 1;
        self.rollouts = rollouts;
        Ok(())
    }

    /// The last numbers of a rollout's observations, `[samples][latent]`.
    fn latents_of(&self, rollout: &Rollout) -> Array {
        let width = self.spec.observation.dim();
        let range = width - self.diversity.latent..width;
        rows::columns(&self.device, &rollout.observation, width, range)
    }

    /// What samples of rollouts end with for the loss of latents that lead to the same actions: see [`Diversity`].
    fn under_other_latents(&self, rollouts: &[Rollout]) -> Option<Array> {
        if self.diversity.width(self.spec.action) == 0 {
            return None;
        }
        let parts = rollouts.iter().zip(&self.latents);
        let parts: Vec<Array> = parts
            .map(|(rollout, latents)| self.under_another(rollout, latents))
            .collect();
        Some(rows::join(&self.device, &parts.iter().collect::<Vec<_>>()))
    }

    /// Pairs every sample with another environment's of the same step. `latents` are as they are drawn, while the
    /// rollout's observations are normalised.
    fn under_another(&self, rollout: &Rollout, latents: &Array) -> Array {
        let (device, latent) = (&self.device, self.diversity.latent);
        let (width, samples) = (self.spec.observation.dim(), rollout.samples());
        let (body, count) = (width - latent, rollout.spec.rows());
        let [bits, ..] = random4(self.seed, 0, self.updates as u32, OTHER_LATENT);
        let shift = 1 + index_below(bits, count as u32 - 1) as usize;
        let other = |at: usize| (at / count * count + (at + shift) % count) as u32;
        let numbers: Vec<u32> = (0..samples).map(other).collect();
        let pick = |latents: &Array| rows::pick(device, latents, latent, &numbers);
        let own = rows::columns(device, &rollout.observation, width, 0..body);
        let seen = [(&own, body), (&pick(&self.latents_of(rollout)), latent)];
        let seen = rows::beside(device, &seen);
        let mut mean = Array::zeroed(device, samples * self.spec.action);
        self.engine
            .forward(ACTOR, &self.parameters, &seen, 0, samples, &mut mean, 0);
        let columns = [
            (&mean, self.spec.action),
            (latents, latent),
            (&pick(latents), latent),
        ];
        rows::beside(device, &columns)
    }

    /// One gradient step on a minibatch, of which this rank has so many samples.
    fn step(&mut self, batch: &Batch, samples: Range<usize>) -> Result<()> {
        let inv_count = 1.0 / (samples.len() * self.ranks.count()) as f32;
        let objective = PpoLoss {
            action: self.spec.action,
            values: self.sources.len(),
            log_std: self.networks.log_std(),
            old_log_std: &self.log_std,
            diversity: self.diversity,
            coefficients: LossCoefficients {
                inv_count,
                ..LossCoefficients::new(&self.config, self.kl_coefficient)
            },
        };
        let mut sums = match self.ranks.is_alone() {
            true => self.sums.clone(),
            // What other ranks have added has been added here, too.
            false => Array::zeroed(&self.device, SUMS),
        };
        self.engine.gradient(
            &self.parameters,
            &batch.rows,
            batch.width,
            batch.minibatch(samples.clone()),
            &objective,
            &mut self.gradient,
            &mut sums,
        );
        match self.ranks.is_alone() {
            true => self.sums = sums,
            false => {
                let arrays = &mut [&mut self.gradient, &mut sums];
                self.ranks.sum_arrays(&self.device, arrays)?;
                rows::add_scaled(&self.device, &sums, 0..SUMS, 1.0, &mut self.sums);
            }
        }
        if self.updates < self.actor_from {
            self.keep_actor();
        } else if self.config.adapt_each_minibatch {
            let rate = |rate: f64| (rate / self.learning_rate) as f32;
            let params = adapt_lr::Params {
                kl_at: KL as u32,
                inv_count,
                first: u32::from(samples.start == 0),
                desired_kl: self.config.desired_kl as f32,
                least: rate(MINIBATCH_LR_RANGE[0]),
                most: rate(MINIBATCH_LR_RANGE[1]),
            };
            self.adam.adapt(&mut self.sums, &params);
        }
        self.adam.step(
            &mut self.parameters,
            &self.gradient,
            self.learning_rate,
            self.config.max_grad_norm,
        );
        Ok(())
    }

    /// Takes from the gradient what would change the actor.
    fn keep_actor(&mut self) {
        for range in [self.networks.actor.span(), self.networks.log_std()] {
            let none = Array::zeroed(&self.device, range.len());
            rows::replace(&self.device, &mut self.gradient, range.start, &none);
        }
    }

    /// Adapts learning rate and KL penalty to the KL divergence of the last update, if it moved the actor.
    fn adapt(&mut self, kl: f64, steps: u64) {
        if self.updates <= self.actor_from {
            return;
        }
        let config = &self.config;
        if config.desired_kl > 0.0 && !config.adapt_each_minibatch {
            let lr = self.learning_rate;
            if kl > 2.0 * config.desired_kl {
                self.learning_rate = (lr / LR_FACTOR).max(lr.min(LR_RANGE[0]));
            } else if kl < 0.5 * config.desired_kl {
                self.learning_rate = (lr * LR_FACTOR).min(lr.max(LR_RANGE[1]));
            }
        }
        if config.anneal_steps > 0 {
            let done = (steps as f64 / config.anneal_steps as f64).min(1.0);
            let ceiling = config.learning_rate * (1.0 - done * (1.0 - config.final_lr_fraction));
            self.learning_rate = match config.desired_kl > 0.0 {
                true => self.learning_rate.min(ceiling),
                false => ceiling,
            };
        }
        if config.kl_coefficient > 0.0 {
            if kl > 2.0 * config.kl_penalty_target {
                self.kl_coefficient *= 1.5;
            } else if kl < 0.5 * config.kl_penalty_target {
                self.kl_coefficient *= 0.5;
            }
        }
    }

    /// Takes in the style reward of an update that moved the actor, and weighs its rewards anew.
    fn weigh(&mut self, style: Option<f64>) {
        if self.updates <= self.actor_from {
            return;
        }
        if let (Some(weight), Some(style)) = (&mut self.task_weight, style) {
            weight.update(style);
            self.set_weights();
        }
    }

    /// Gives the advantages of task and style their weights, where a rule finds them.
    fn set_weights(&mut self) {
        let weights = self.task_weight.as_ref().and_then(TaskWeight::weights);
        for (source, weight) in weights.into_iter().flatten() {
            let stream = self.sources.iter().position(|own| *own == source);
            if let Some(stream) = stream {
                self.value_normalizer.set_weight(stream, weight);
            }
        }
    }

    /// The objective's sums over the last epoch; behind them that of the style rewards, if there are any.
    fn read_sums(&self) -> Result<Vec<f32>> {
        if self.task_weight.is_none() {
            return self.sums.read(&self.device);
        }
        let mut style = Array::zeroed(&self.device, 1);
        for rollout in &self.rollouts {
            rows::add_sum(&self.device, &rollout.style_reward, &mut style);
        }
        self.ranks.sum_arrays(&self.device, &mut [&mut style])?;
        rows::join(&self.device, &[&self.sums, &style]).read(&self.device)
    }

    /// Samples of the rollouts of all ranks.
    fn samples(&self) -> usize {
        let own: usize = self.rollouts.iter().map(Rollout::samples).sum();
        own * self.ranks.count()
    }

    /// Means over the last epoch, and what else is worth a curve.
    ///
    /// # Errors
    /// The device was lost; or a number is not finite.
    fn losses(&mut self) -> Result<Vec<(&'static str, f64)>> {
        let samples = self.samples();
        let sums = self.read_sums()?;
        let grad_norm = self.adam.grad_norm()?;
        let scale = self.value_normalizer.advance()?;
        let mean = |i: usize| f64::from(sums[i]) / samples as f64;
        let mut losses = vec![
            ("policy_loss", mean(0)),
            ("value_loss", mean(1)),
            ("entropy", mean(2)),
            ("kl", mean(KL)),
            ("clip_fraction", mean(4)),
            (
                "explained_variance",
                scale[scale::EXPLAINED_VARIANCE].into(),
            ),
            ("grad_norm", grad_norm.into()),
            (
                "learning_rate",
                self.learning_rate * f64::from(self.adam.rate()?),
            ),
        ];
        if let Some(weight) = &self.task_weight {
            losses.push(("style_reward", mean(SUMS)));
            losses.extend(weight.metrics());
        }
        match losses.iter().find(|(_, value)| !value.is_finite()) {
            None => Ok(losses),
            Some((name, value)) => bail!(
                "learning diverged: the {} of update {} is {value}; checkpoints are from before it, if one \
                 was due. Try a lower ppo.learning_rate",
                name.replace('_', " "),
                self.updates
            ),
        }
    }

    /// Closes an iteration whose rollouts have been learned from: what it lost and what its environments
    /// counted. `begin` is when it began, `steps` are the environment steps before it.
    pub(in crate::rl) fn conclude(
        &mut self,
        envs: &mut EnvBatch,
        steps: u64,
        begin: Instant,
        [policy_s, env_s]: [f64; 2],
    ) -> Result<Iteration> {
        let losses = self.losses()?;
        let names = envs.stat_names();
        let mut sums = Array::zeroed(&self.device, names.len());
        envs.stats(&mut sums);
        self.ranks.sum_arrays(&self.device, &mut [&mut sums])?;
        let stats = Stats::new(names, &sums.read(&self.device)?);
        if let Some((name, sum)) = stats.iter().find(|(_, sum)| !sum.is_finite()) {
            bail!(
                "the environments diverged: the sum of {name} in update {} is {sum}",
                self.updates
            );
        }
        let iteration = Iteration {
            losses,
            stats,
            policy_s,
            env_s,
            learn_s: begin.elapsed().as_secs_f64() - policy_s - env_s,
        };
        let kl = iteration.loss("kl").unwrap_or(0.0);
        self.adapt(kl, steps + self.samples() as u64);
        self.weigh(iteration.loss("style_reward"));
        Ok(iteration)
    }
}

impl Algorithm for PpoLearner {
    fn iterate(&mut self, envs: &mut EnvBatch, steps: u64) -> Result<Iteration> {
        let begin = Instant::now();
        let [_, env_s] = self.collect(envs)?;
        self.estimate()?;
        let policy_s = begin.elapsed().as_secs_f64() - env_s;
        self.learn()?;
        self.conclude(envs, steps, begin, [policy_s, env_s])
    }

    fn policy(&self) -> Result<Policy> {
        let normalizer = self.observation_normalizer.as_ref();
        let spec = &self.spec;
        let (action, values) = (spec.action, self.sources.len());
        let mut policy = Policy::new(&self.config.network, &spec.observation, action, values)?;
        policy.parameters = self.parameters.read(&self.device)?;
        policy.normalizer = normalizer.map(RunningMeanStd::on_host).transpose()?;
        Ok(policy)
    }

    fn start_from(&mut self, policy: &Policy, section: &mut Section) -> Result<(), SectionError> {
        let lost = |error: anyhow::Error| SectionError(error.to_string());
        let mut flat = self.parameters.read(&self.device).map_err(lost)?;
        adopt_actor(
            &policy.networks().actor,
            &policy.parameters,
            &self.networks.actor,
            &mut flat,
        )?;
        flat[self.networks.log_std()].copy_from_slice(policy.log_std());
        self.parameters = Array::from_slice(&self.device, &flat);
        if let (Some(own), Some(other)) = (&mut self.observation_normalizer, &policy.normalizer) {
            *own = other.widened(own.dim()).on(&self.device);
        }
        self.actor_from = CRITIC_ALONE;
        match &mut self.task_weight {
            None => Ok(()),
            Some(weight) => weight.start_from(&mut section.take_section("task_weight")),
        }
    }

    fn save(&self, to: &mut Section) -> Result<()> {
        to.put("updates", [self.updates, self.actor_from]);
        to.put_array("rates", &[self.learning_rate, self.kl_coefficient]);
        if let Some(weight) = &self.task_weight {
            let mut own = Section::default();
            weight.save(&mut own);
            to.put_section("task_weight", own);
        }
        self.adam.save(to)?;
        self.value_normalizer.save(to)
    }

    fn load(&mut self, from: &mut Section, policy: &Policy) -> Result<(), SectionError> {
        [self.updates, self.actor_from] = from.get("updates")?;
        let rates: Vec<f64> = from.take_array("rates", 2)?;
        if !rates.iter().all(|rate| rate.is_finite()) {
            return Err(SectionError("its rates are not finite".to_string()));
        }
        (self.learning_rate, self.kl_coefficient) = (rates[0], rates[1]);
        if let Some(weight) = &mut self.task_weight {
            weight.load(&mut from.take_section("task_weight"))?;
        }
        self.adam.load(from)?;
        self.value_normalizer.load(from)?;
        self.parameters = Array::from_slice(&self.device, &policy.parameters);
        let normalizer = policy.normalizer.as_ref();
        self.observation_normalizer = normalizer.map(|running| running.on(&self.device));
        Ok(())
    }
}
