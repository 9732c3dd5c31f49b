//! Environments of two agents as environments of one, who plays against opponents.

use super::Opponent;
use super::pool::{BoutResult, Opponents};
use crate::container::{Section, SectionError};
use crate::env::termination::RUNNING;
use crate::env::{EnvSpec, Transition, VecEnv};
use crate::gpu::{Array, Device};
use crate::kernels::rng::{index_below, random4};
use crate::nn::rows;
use crate::rl::step_columns::StepColumns;
use anyhow::{Result, bail};
use std::sync::Arc;

/// Random stream of who meets whom.
const BOUTS: u32 = 0x424f_5554;
/// Makes the opponents' noise another than the learner's.
const OPPONENT_SEED: u32 = 0x4f50_5053;

/// Environments of two agents, of which the learner plays one: either, by chance, drawn anew for every bout. The other
/// is played by an opponent that is drawn then, too; each acts once a step, for all its rows together, and on the host.
/// Rewards, terminations, observations and statistics are the learner's.
///
/// A bout whose opponent has left the pool is played on by the newest.
pub struct SelfPlayEnv {
    device: Device,
    inner: Box<dyn VecEnv>,
    spec: EnvSpec,
    opponents: Arc<Opponents>,
    /// `[envs]`
    bouts: Vec<Pairing>,
    /// Bouts that have ended since they were last taken, unless the device was lost.
    results: Result<Vec<BoutResult>>,
    /// Sums over the learner's episodes that have ended, `[stats]`, and the index of successes in them.
    sums: Vec<f32>,
    successes: usize,
    /// Sums of all inner rows, `[2 envs][stats]`.
    row_stats: Vec<f32>,
    /// `[2 envs][observation]` of the inner environments.
    observation: Array,
    step: StepColumns,
    seed: u32,
    /// Number of the first environment in the whole batch.
    first: u32,
    step_counter: u32,
}

/// Who plays whom in an environment.
#[derive(Clone, Copy)]
struct Pairing {
    /// The learner's agent, 0 or 1.
    agent: usize,
    /// Number of the opponent.
    opponent: u32,
}

impl SelfPlayEnv {
    /// Environments around those of two agents on `device`, of which the first has the number `first` in the whole
    /// batch. Their first opponent repeats the action at rest.
    ///
    /// # Errors
    /// They have other agents, or do not tell who wins; or the device was lost.
    pub fn new(
        inner: Box<dyn VecEnv>,
        device: &Device,
        first: usize,
        seed: u32,
    ) -> Result<SelfPlayEnv> {
        let (spec, names) = (*inner.spec(), inner.stat_names());
        let row_stats = inner.row_stats()?;
        let successes = names.iter().position(|name| *name == "successes");
        let (2, Some(successes), false) = (spec.agents, successes, row_stats.is_empty()) else {
            bail!("self-play takes environments of two agents that tell who wins");
        };
        let observation = spec.observation.dim();
        let mut rest = inner.rest_action();
        rest.resize(spec.action, 0.0);
        let mut envs = SelfPlayEnv {
            opponents: Arc::new(Opponents::only(Opponent::repeating(rest, observation))),
            bouts: Vec::new(),
            results: Ok(Vec::new()),
            sums: vec![0.0; names.len()],
            successes,
            row_stats,
            observation: Array::zeroed(device, spec.rows() * observation),
            step: StepColumns::new(device, spec.rows(), observation),
            spec: EnvSpec { agents: 1, ..spec },
            device: device.clone(),
            seed,
            first: first as u32,
            step_counter: 0,
            inner,
        };
        envs.bouts = (0..spec.envs).map(|env| envs.draw(env)).collect();
        Ok(envs)
    }

    /// The opponents of the bouts that begin from now on.
    pub fn set_opponents(&mut self, opponents: &Arc<Opponents>) {
        self.opponents = opponents.clone();
    }

    /// The bouts that have ended since the last call.
    ///
    /// # Errors
    /// The device was lost.
    pub fn take_results(&mut self) -> Result<Vec<BoutResult>> {
        std::mem::replace(&mut self.results, Ok(Vec::new()))
    }

    /// Who plays whom from now on.
    fn draw(&self, env: usize) -> Pairing {
        let number = self.first + env as u32;
        let [agent, opponent, ..] = random4(self.seed, number, self.step_counter, BOUTS);
        Pairing {
            agent: index_below(agent, 2) as usize,
            opponent: self.opponents.draw(opponent),
        }
    }

    /// The inner rows of the learner, `[envs]`.
    fn own_rows(&self) -> Vec<u32> {
        let bouts = self.bouts.iter().enumerate();
        bouts
            .map(|(env, bout)| (2 * env + bout.agent) as u32)
            .collect()
    }

    /// Plays a step; the learner's actions are `[envs][action]`.
    fn play(&mut self, learner: &Array, mut out: Transition) -> Result<()> {
        let action = self.beside_opponents(learner)?;
        self.inner.step(&action, 0, self.step.transition());
        self.step_counter += 1;
        let own = self.step.pick(&self.device, &self.own_rows())?;
        own.count(&self.device, &self.spec, 0, 1.0, &mut out);
        self.end_bouts(&own.termination.read(&self.device)?)
    }

    /// The actions of the inner environments, `[2 envs][action]`.
    fn beside_opponents(&mut self, learner: &Array) -> Result<Array> {
        self.inner.observe(&mut self.observation, 0);
        let theirs = self.opponents_actions(&self.observation.read(&self.device)?);
        let theirs = Array::from_slice(&self.device, &theirs);
        let all = rows::join(&self.device, &[learner, &theirs]);
        let envs = self.bouts.len() as u32;
        let pair = |(env, bout): (u32, &Pairing)| match bout.agent {
            0 => [env, envs + env],
            _ => [envs + env, env],
        };
        let numbers: Vec<u32> = (0..envs).zip(&self.bouts).flat_map(pair).collect();
        Ok(rows::pick(&self.device, &all, self.spec.action, &numbers))
    }

    /// What the opponents do, `[envs][action]`, when the agents observe `[2 envs][observation]`.
    fn opponents_actions(&self, observation: &[f32]) -> Vec<f32> {
        let (dim, width) = (self.spec.observation.dim(), self.spec.action);
        let mut all = vec![0.0; self.bouts.len() * width];
        for (index, opponent) in self.opponents.iter().enumerate() {
            let met = |env: &usize| self.opponents.index(self.bouts[*env].opponent) == index;
            let envs: Vec<usize> = (0..self.bouts.len()).filter(met).collect();
            if envs.is_empty() {
                continue;
            }
            let row =
                |&env: &usize| &observation[(2 * env + 1 - self.bouts[env].agent) * dim..][..dim];
            let seen: Vec<f32> = envs.iter().flat_map(row).copied().collect();
            let numbers: Vec<u32> = envs.iter().map(|&env| self.first + env as u32).collect();
            let seed = self.seed ^ OPPONENT_SEED;
            let actions = opponent.act(&seen, &numbers, seed, self.step_counter);
            for (env, action) in envs.iter().zip(actions.chunks_exact(width)) {
                all[env * width..][..width].copy_from_slice(action);
            }
        }
        all
    }

    /// Counts the bouts that have ended, by how the learner's did, and draws those that begin.
    fn end_bouts(&mut self, ends: &[u32]) -> Result<()> {
        if ends.iter().all(|&end| end == RUNNING) {
            return Ok(());
        }
        let (now, stats) = (self.inner.row_stats()?, self.sums.len());
        for env in (0..ends.len()).filter(|&env| ends[env] != RUNNING) {
            let Pairing { agent, opponent } = self.bouts[env];
            let gained = |agent: usize, stat: usize| {
                let at = (2 * env + agent) * stats + stat;
                now[at] - self.row_stats[at]
            };
            let [won, lost] = [agent, 1 - agent].map(|agent| gained(agent, self.successes));
            let own = self.sums.iter().enumerate();
            self.sums = own.map(|(stat, sum)| sum + gained(agent, stat)).collect();
            if let Ok(results) = &mut self.results {
                results.push(BoutResult {
                    opponent,
                    score: (0.5 * (1.0 + won - lost)).clamp(0.0, 1.0),
                });
            }
            self.bouts[env] = self.draw(env);
        }
        self.row_stats = now;
        Ok(())
    }
}

impl VecEnv for SelfPlayEnv {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn inner(&self) -> Option<&dyn VecEnv> {
        Some(&*self.inner)
    }

    fn inner_mut(&mut self) -> Option<&mut dyn VecEnv> {
        Some(&mut *self.inner)
    }

    fn row_stats(&self) -> Result<Vec<f32>> {
        // The inner rows are of both agents.
        Ok(Vec::new())
    }

    fn observe(&mut self, out: &mut Array, at: usize) {
        self.inner.observe(&mut self.observation, 0);
        let (device, dim) = (&self.device, self.spec.observation.dim());
        let own = rows::pick(device, &self.observation, dim, &self.own_rows());
        rows::replace(device, out, at, &own);
    }

    fn step(&mut self, action: &Array, at: usize, out: Transition) {
        let numbers = self.bouts.len() * self.spec.action;
        let learner = action.copy(&self.device, at..at + numbers);
        if let Err(error) = self.play(&learner, out) {
            self.results = Err(error);
        }
    }

    fn stat_names(&self) -> &'static [&'static str] {
        self.inner.stat_names()
    }

    fn stats(&mut self, out: &mut Array) {
        // The inner sums are of both agents; they begin anew.
        self.inner.stats(out);
        self.row_stats.fill(0.0);
        *out = Array::from_slice(&self.device, &self.sums);
        self.sums.fill(0.0);
    }

    fn save(&self, to: &mut Section) -> Result<()> {
        let mut inner = Section::default();
        self.inner.save(&mut inner)?;
        to.put_section("inner", inner);
        to.put("bout_steps", self.step_counter);
        let bouts = self
            .bouts
            .iter()
            .map(|bout| [bout.agent as u32, bout.opponent]);
        to.put_array("bouts", &bouts.collect::<Vec<_>>());
        to.put_array("bout_sums", &self.sums);
        Ok(())
    }

    fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        self.inner.load(&mut from.take_section("inner"))?;
        let lost = |error: anyhow::Error| SectionError(error.to_string());
        self.row_stats = self.inner.row_stats().map_err(lost)?;
        self.step_counter = from.get("bout_steps")?;
        self.sums = from.take_finite("bout_sums", self.sums.len())?;
        let bouts: Vec<[u32; 2]> = from.take_array("bouts", self.bouts.len())?;
        if bouts.iter().any(|&[agent, _]| agent > 1) {
            return Err(SectionError("a bout has more than two agents".into()));
        }
        let bout = |[agent, opponent]: [u32; 2]| Pairing {
            agent: agent as usize,
            opponent,
        };
        self.bouts = bouts.into_iter().map(bout).collect();
        Ok(())
    }
}
