//! Tells recorded motion from that of agents, and rewards agents for what it takes for recorded.

use super::adaptive_steps::AdaptiveSteps;
use super::loss::{COSINE, SUMS, TellApart};
use super::replay::Replay;
use super::{Amp, DiscriminatorLoss, LatentUse, style};
use crate::container::{Section, SectionError};
use crate::env::Demonstrations;
use crate::gpu::{Array, Device};
use crate::kernels::learn::{skill_reward, style_reward, style_windows};
use crate::kernels::rng::{gaussian, index_below, random4};
use crate::nn::layer::Activation;
use crate::nn::network::{Network, NetworkConfig};
use crate::nn::observation::ObservationSpec;
use crate::nn::{Adam, Engine, EngineSize, Rows, RunningMeanStd, rows};
use crate::ranks::Ranks;
use crate::rl::rollout::Rollout;
use anyhow::{Result, bail};
use std::sync::Arc;

/// First random stream of what a gradient step sees: recorded windows, fresh ones, replayed ones.
const STREAM: u32 = 0x4449_5343;

/// A discriminator of windows of two moments, with what it needs to learn.
pub struct Discriminator {
    config: Amp,
    latents: LatentUse,
    device: Device,
    ranks: Ranks,
    demonstrations: Arc<Demonstrations>,
    /// `[n][dim]`
    recorded: Array,
    network: Network,
    engine: Engine,
    parameters: Array,
    adam: Adam,
    gradient: Array,
    normalizer: RunningMeanStd,
    replay: Replay,
    /// Windows of the present rollouts, `[samples][dim]`.
    fresh: Array,
    /// The latents that an encoder is to find in them, `[samples][found]`.
    fresh_latents: Array,
    sums: Array,
    /// Sum of the penalties' squared norms.
    penalties: Array,
    /// Sum of the skill rewards of the present rollouts.
    skill: Array,
    steps: AdaptiveSteps,
    updates: u64,
    seed: u32,
}

impl Discriminator {
    /// A discriminator that is new to agents of `samples` samples an update on each rank. Where it is shown latents, the
    /// demonstrations' windows end with them.
    ///
    /// # Errors
    /// There can be no such network, or not on this device.
    pub fn new(
        config: &Amp,
        latents: LatentUse,
        demonstrations: &Arc<Demonstrations>,
        device: &Device,
        ranks: &Ranks,
        samples: usize,
        seed: u32,
    ) -> Result<Self> {
        let config = Amp {
            minibatch_size: ranks.portion(config.minibatch_size),
            replay_per_update: ranks.portion(config.replay_per_update),
            ..config.clone()
        };
        if config.replay_capacity < ranks.count() {
            bail!(
                "amp.replay_capacity has to be at least the number of ranks, {}",
                ranks.count()
            );
        }
        let dim = demonstrations.dim;
        let network = network(&config, dim, latents)?;
        let parameters = network.span().len();
        let size = EngineSize {
            parameters,
            extras: SUMS,
            max_rows: samples,
            minibatch: 2 * config.minibatch_size,
        };
        Ok(Discriminator {
            recorded: Array::from_slice(device, &demonstrations.windows),
            parameters: Array::from_slice(device, &init(&network, seed)),
            engine: Engine::layerwise(device, vec![network.clone()], size)?,
            adam: Adam::new(device, parameters),
            gradient: Array::zeroed(device, parameters),
            normalizer: RunningMeanStd::new(device, dim),
            replay: Replay::new(device, config.replay_capacity, dim),
            fresh: Array::zeroed(device, 0),
            fresh_latents: Array::zeroed(device, 0),
            sums: Array::zeroed(device, SUMS),
            penalties: Array::zeroed(device, 1),
            skill: Array::zeroed(device, 1),
            steps: AdaptiveSteps::new(config.steps),
            updates: 0,
            seed,
            config,
            latents,
            ranks: ranks.clone(),
            device: device.clone(),
            demonstrations: demonstrations.clone(),
            network,
        })
    }

    fn dim(&self) -> usize {
        self.demonstrations.dim
    }

    /// Fills in the rewards of rollouts whose observations are raw: of the style, and of an encoder's finding
    /// the latents.
    pub fn reward(&mut self, rollouts: &mut [Rollout]) {
        self.skill = Array::zeroed(&self.device, 1);
        let (mut fresh, mut fresh_latents) = (Vec::new(), Vec::new());
        for rollout in rollouts {
            let latents = self.latents_of(rollout);
            let windows = self.windows(rollout, &latents);
            let output = self.output(&windows, rollout.samples());
            self.reward_style(&output, rollout);
            if self.latents.found() > 0 {
                self.reward_skill(&output, &latents, rollout);
            }
            fresh.push(windows);
            fresh_latents.push(latents);
        }
        self.fresh = rows::join(&self.device, &fresh.iter().collect::<Vec<_>>());
        self.fresh_latents = rows::join(&self.device, &fresh_latents.iter().collect::<Vec<_>>());
    }

    /// The latents of a rollout, `[samples][latent]`.
    fn latents_of(&self, rollout: &Rollout) -> Array {
        let width = rollout.spec.observation.dim();
        let range = width - self.latents.dim()..width;
        match range.is_empty() {
            true => Array::zeroed(&self.device, 0),
            false => rows::columns(&self.device, &rollout.observation, width, range),
        }
    }

    /// The network's outputs for so many windows, `[samples][outputs]`.
    fn output(&self, windows: &Array, samples: usize) -> Array {
        let mut seen = windows.clone();
        self.normalizer.normalize_in_place(&mut seen, samples);
        let mut output = Array::zeroed(&self.device, samples * self.network.outputs());
        self.engine
            .forward(0, &self.parameters, &seen, 0, samples, &mut output, 0);
        output
    }

    fn reward_style(&self, output: &Array, rollout: &mut Rollout) {
        let params = style_reward::Params {
            samples: rollout.samples() as u32,
            outputs: self.network.outputs() as u32,
            heads: self.config.heads as u32,
            hinge: u32::from(self.config.loss == DiscriminatorLoss::Hinge),
        };
        style::reward(&self.device, output, &mut rollout.style_reward, &params);
    }

    fn reward_skill(&mut self, output: &Array, latents: &Array, rollout: &mut Rollout) {
        let params = skill_reward::Params {
            samples: rollout.samples() as u32,
            outputs: self.network.outputs() as u32,
            heads: self.config.heads as u32,
        };
        let reward = &mut rollout.skill_reward;
        match &self.device {
            Device::Cpu => {
                skill_reward::twin(output.host(), latents.host(), reward.host_mut(), &params);
            }
            Device::Gpu(gpu) => {
                let (output, latents) = (output.buffer(), latents.buffer());
                skill_reward::launch(gpu, output, latents, reward.buffer(), &params);
            }
        }
        rows::add_sum(&self.device, reward, &mut self.skill);
    }

    /// The windows of a rollout, `[samples][dim]`.
    fn windows(&self, rollout: &Rollout, latents: &Array) -> Array {
        let spec = &rollout.spec;
        let params = style_windows::Params {
            steps: rollout.steps as u32,
            rows: spec.rows() as u32,
            observation: spec.observation.dim() as u32,
            style: spec.style as u32,
            final_steps: spec.final_steps(rollout.steps) as u32,
        };
        let window = self.dim() - self.latents.shown();
        let mut windows = Array::zeroed(&self.device, rollout.samples() * window);
        let moments = style::Moments {
            observation: &rollout.observation,
            next_observation: &rollout.next_observation,
            final_observation: &rollout.final_observation,
            termination: &rollout.termination,
        };
        style::windows(&self.device, &moments, &mut windows, &params);
        match self.latents {
            LatentUse::Conditioned(dim) => {
                rows::beside(&self.device, &[(&windows, window), (latents, dim)])
            }
            LatentUse::None | LatentUse::Encoded(_) => windows,
        }
    }

    /// Learns from the windows that [`Discriminator::reward`] saw last.
    ///
    /// # Errors
    /// The device was lost.
    pub fn learn(&mut self) -> Result<()> {
        let dim = self.dim();
        let fresh = self.fresh.len() / dim;
        if self.updates == 0 {
            self.normalize_by(fresh)?;
        }
        if self.replay.len() == 0 {
            self.keep(fresh)?;
        }
        self.sums = Array::zeroed(&self.device, SUMS);
        self.penalties = Array::zeroed(&self.device, 1);
        for step in 0..self.steps.count() {
            self.step(step)?;
        }
        if self.updates > 0 {
            self.normalize_by(fresh)?;
            self.keep(fresh)?;
        }
        self.updates += 1;
        Ok(())
    }

    /// This rank's `count` numbers of a stream of the present update.
    fn draw(&self, stream: u32, count: usize, of: impl Fn(u32) -> u32) -> Vec<u32> {
        let first = (self.ranks.rank().number * count) as u32;
        let numbers = first..first + count as u32;
        let bits = |number| random4(self.seed, number, self.updates as u32, STREAM + stream)[0];
        numbers.map(|number| of(bits(number))).collect()
    }

    /// Lets windows of both sides into the normaliser.
    fn normalize_by(&mut self, fresh: usize) -> Result<()> {
        let count = fresh.min(self.config.replay_per_update);
        let recorded = self.draw(0, count, |bits| self.demonstrations.draw(bits));
        let agents = self.draw(1, count, |bits| index_below(bits, fresh as u32));
        let dim = self.dim();
        for (from, numbers) in [(&self.recorded, recorded), (&self.fresh, agents)] {
            let picked = rows::pick(&self.device, from, dim, &numbers);
            self.normalizer.update_over(&self.ranks, &picked, count)?;
        }
        Ok(())
    }

    /// Puts some of the fresh windows into the replay, which holds those of all ranks.
    fn keep(&mut self, fresh: usize) -> Result<()> {
        let count = self.config.replay_per_update.min(fresh);
        let count = count.min(self.config.replay_capacity / self.ranks.count());
        let kept = self.draw(2, count, |bits| index_below(bits, fresh as u32));
        let kept = rows::pick(&self.device, &self.fresh, self.dim(), &kept);
        self.replay.push(&self.ranks.join(&self.device, &kept)?);
        Ok(())
    }

    /// One gradient step, on this rank's share of the samples.
    fn step(&mut self, step: usize) -> Result<()> {
        let (count, dim) = (self.config.minibatch_size, self.dim());
        let stream = 3 + 3 * step as u32;
        let (fresh, replayed) = (self.fresh.len() / dim, self.replay.len());
        let (half, ranks) = (count / 2, self.ranks.count());
        let numbers = [
            self.draw(stream, count, |bits| self.demonstrations.draw(bits)),
            self.draw(stream + 1, count - half, |bits| {
                index_below(bits, fresh as u32)
            }),
            self.draw(stream + 2, half, |bits| index_below(bits, replayed as u32)),
        ];
        let sources = [&self.recorded, &self.fresh, self.replay.windows()];
        let parts: Vec<Array> = sources
            .into_iter()
            .zip(&numbers)
            .filter(|(_, numbers)| !numbers.is_empty())
            .map(|(from, numbers)| rows::pick(&self.device, from, dim, numbers))
            .collect();
        let mut windows = rows::join(&self.device, &parts.iter().collect::<Vec<_>>());
        self.normalizer.normalize_in_place(&mut windows, 2 * count);
        let labels = [vec![1.0; count], vec![0.0; count]].concat();
        let labels = Array::from_slice(&self.device, &labels);
        let latent = self.latents.found();
        let found = match latent {
            0 => None,
            _ => Some(self.latents_to_find(&numbers[1], 2 * count)),
        };
        let columns = [(&windows, dim), (&labels, 1)];
        let columns: Vec<_> = columns
            .into_iter()
            .chain(found.as_ref().map(|found| (found, latent)))
            .collect();
        let samples = rows::beside(&self.device, &columns);
        let width = dim + 1 + latent;
        let objective = TellApart {
            loss: self.config.loss,
            window: dim,
            heads: self.config.heads,
            latent,
            inv_count: 0.5 / (count * ranks) as f32,
            inv_latents: 1.0 / ((count - half) * ranks) as f32,
        };
        self.engine.gradient(
            &self.parameters,
            &samples,
            width,
            Rows::Range(0..2 * count),
            &objective,
            &mut self.gradient,
            &mut self.sums,
        );
        self.engine.add_gradient_penalty(
            0,
            &self.parameters,
            &samples,
            width,
            0..count,
            self.config.heads,
            self.config.gradient_penalty / ranks as f32,
            &mut self.gradient,
            &mut self.penalties,
        );
        self.ranks
            .sum_arrays(&self.device, &mut [&mut self.gradient])?;
        let last = self.network.layers().last().map(|last| last.weights());
        rows::add_scaled(
            &self.device,
            &self.parameters,
            last.unwrap_or_default(),
            self.config.logit_decay,
            &mut self.gradient,
        );
        let (rate, max) = (self.config.learning_rate, self.config.max_grad_norm);
        self.adam
            .step(&mut self.parameters, &self.gradient, rate, max);
        Ok(())
    }

    /// The latents of a step's samples, `[samples][latent]`: those of fresh windows by their numbers, which
    /// follow as many recorded ones as half of the samples; zero for all others.
    fn latents_to_find(&self, fresh: &[u32], samples: usize) -> Array {
        let latent = self.latents.found();
        let none = |rows: usize| Array::zeroed(&self.device, rows * latent);
        let found = rows::pick(&self.device, &self.fresh_latents, latent, fresh);
        let before = samples / 2;
        let parts = [none(before), found, none(samples - before - fresh.len())];
        let parts: Vec<&Array> = parts.iter().filter(|part| !part.is_empty()).collect();
        rows::join(&self.device, &parts)
    }

    /// Closes an update whose style reward of a step is known: what the discriminator lost, and how often it was
    /// right, by their names in `metrics.jsonl`.
    ///
    /// # Errors
    /// The device was lost.
    pub fn conclude(&mut self, style: f64) -> Result<Vec<(&'static str, f64)>> {
        let all = &mut [&mut self.sums, &mut self.penalties, &mut self.skill];
        self.ranks.sum_arrays(&self.device, all)?;
        let sums = self.sums.read(&self.device)?;
        let penalties = self.penalties.read(&self.device)?[0];
        let of = |i: usize| f64::from(sums[i]);
        let recorded = of(1).max(1.0);
        let agents = of(4) / of(3).max(1.0);
        let steps = self.steps.count();
        self.steps.update(agents, style);
        let mut measures = vec![
            ("discriminator_steps", steps as f64),
            ("discriminator_loss", of(0) / (of(1) + of(3)).max(1.0)),
            ("discriminator_penalty", f64::from(penalties) / recorded),
            ("recorded_accuracy", of(2) / recorded),
            ("agent_accuracy", agents),
        ];
        if self.latents.found() > 0 {
            let samples = self.ranks.count() * (self.fresh.len() / self.dim()).max(1);
            let skill = f64::from(self.skill.read(&self.device)?[0]) / samples as f64;
            // Of the agents' windows of a step, the fresh ones have a latent.
            let count = self.config.minibatch_size;
            let found = of(3) * (count - count / 2) as f64 / count as f64;
            measures.push(("skill_reward", skill));
            measures.push(("encoder_cosine", of(COSINE) / found.max(1.0)));
        }
        Ok(measures)
    }

    /// Saves all that it needs to go on as if it had never stopped.
    ///
    /// # Errors
    /// The device was lost.
    pub fn save(&self, to: &mut Section) -> Result<()> {
        to.put("discriminator.updates", self.updates);
        self.steps.save(to);
        let parameters = self.parameters.read(&self.device)?;
        to.put_array("discriminator.parameters", &parameters);
        self.adam.save(to)?;
        self.normalizer.save(to)?;
        self.replay.save(to)
    }

    /// Puts a saved state back.
    ///
    /// # Errors
    /// It is of another discriminator.
    pub fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        self.updates = from.get("discriminator.updates")?;
        self.steps.load(from)?;
        let parameters = from.take_finite("discriminator.parameters", self.parameters.len())?;
        self.parameters = Array::from_slice(&self.device, &parameters);
        self.adam.load(from)?;
        self.normalizer = RunningMeanStd::load(from, self.dim())?.on(&self.device);
        self.replay.load(from)
    }
}

/// The network of a discriminator of windows of `dim` numbers, latents that it is shown included; the outputs of
/// an encoder are behind its heads, on the same trunk.
///
/// # Errors
/// There can be no such network.
pub fn network(
    config: &Amp,
    dim: usize,
    latents: LatentUse,
) -> Result<Network, crate::nn::NetworkError> {
    let hidden = NetworkConfig {
        convolutions: Vec::new(),
        encoder_hidden: Vec::new(),
        hidden: config.hidden.clone(),
        activation: Activation::Relu,
    };
    let window = ObservationSpec {
        vector: dim,
        grid: None,
    };
    Network::new(&hidden, &window, config.heads + latents.found(), 0)
}

/// Gaussian weights that keep the variance through ReLUs, and zero biases.
fn init(network: &Network, seed: u32) -> Vec<f32> {
    const STREAM: u32 = 0x4449_4e49;
    let mut flat = vec![0.0; network.span().end];
    for params in network.layers() {
        let gain = match params.layer.activation() {
            Activation::Relu => 2f32.sqrt(),
            Activation::Tanh | Activation::Identity => 1.0,
        };
        let deviation = gain / (params.layer.patch() as f32).sqrt();
        for at in params.weights() {
            flat[at] = deviation * gaussian(random4(seed, at as u32, 0, STREAM));
        }
    }
    flat
}
