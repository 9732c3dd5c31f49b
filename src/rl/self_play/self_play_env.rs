//! Environments of two agents as environments of one, who plays against opponents.

use super::pool::{BoutResult, Opponents};
use crate::container::{Section, SectionError};
use crate::env::live_view::LiveView;
use crate::env::termination::RUNNING;
use crate::env::{EnvSpec, Transition, VecEnv};
use crate::gpu::{Array, Device};
use crate::kernels::rng::{index_below, random4};
use crate::rl::step_columns::StepColumns;
use anyhow::{Result, bail};
use std::sync::Arc;

/// Random stream of who meets whom.
const BOUTS: u32 = 0x424f_5554;
/// Makes the opponents' noise another than the learner's.
const OPPONENT_SEED: u32 = 0x4f50_5053;

/// Environments of two agents, of which the learner plays one: either, by chance, drawn anew for every bout. The other
/// is played by an opponent that is drawn then, too; each acts once a step, for all its rows together. Rewards,
/// terminations, observations and statistics are the learner's.
///
/// A bout whose opponent has left the pool is played on by the newest.
pub struct SelfPlayEnv {
    inner: Box<dyn VecEnv>,
    spec: EnvSpec,
    opponents: Arc<Opponents>,
    /// `[envs]`
    bouts: Vec<Bout>,
    /// Bouts that have ended since they were last taken.
    results: Vec<BoutResult>,
    /// Sums over the learner's episodes that have ended, `[stats]`, and the index of successes in them.
    sums: Vec<f32>,
    successes: usize,
    /// `[2 envs][observation]` and `[2 envs][action]` of the inner environments.
    observation: Array,
    action: Array,
    step: StepColumns,
    seed: u32,
    /// Number of the first environment in the whole batch.
    first: u32,
    step_counter: u32,
}

/// Who plays whom in an environment.
#[derive(Clone, Copy)]
struct Bout {
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
    /// They have other agents, do not tell who wins, or are on a GPU.
    pub fn new(
        inner: Box<dyn VecEnv>,
        device: &Device,
        first: usize,
        seed: u32,
    ) -> Result<SelfPlayEnv> {
        let spec = *inner.spec();
        if let Device::Gpu(_) = device {
            bail!("self-play is not there on GPUs yet: give --device cpu");
        }
        let names = inner.stat_names();
        let successes = names.iter().position(|name| *name == "successes");
        let (2, Some(successes)) = (spec.agents, successes) else {
            bail!("self-play takes environments of two agents that tell who wins");
        };
        let zeros = |len: usize| Array::zeroed(device, spec.rows() * len);
        let mut envs = SelfPlayEnv {
            opponents: Arc::new(Opponents::scripted(at_rest(&*inner))),
            bouts: Vec::new(),
            results: Vec::new(),
            sums: vec![0.0; names.len()],
            successes,
            observation: zeros(spec.observation.dim()),
            action: zeros(spec.action),
            step: StepColumns::new(device, spec.rows(), spec.observation.dim()),
            spec: EnvSpec { agents: 1, ..spec },
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
    pub fn take_results(&mut self) -> Vec<BoutResult> {
        std::mem::take(&mut self.results)
    }

    /// Who plays whom from now on.
    fn draw(&self, env: usize) -> Bout {
        let number = self.first + env as u32;
        let [agent, opponent, ..] = random4(self.seed, number, self.step_counter, BOUTS);
        Bout {
            agent: index_below(agent, 2) as usize,
            opponent: self.opponents.draw(opponent),
        }
    }

    /// The rows of the learner and of its opponent.
    fn rows(&self, env: usize) -> [usize; 2] {
        let agent = self.bouts[env].agent;
        [2 * env + agent, 2 * env + 1 - agent]
    }

    /// Puts the learner's actions, `[envs][action]`, and the opponents' beside each other.
    fn act(&mut self, learner: &[f32]) {
        let width = self.spec.action;
        for (env, action) in learner
            .chunks_exact(width)
            .take(self.bouts.len())
            .enumerate()
        {
            let [own, _] = self.rows(env);
            self.action.host_mut()[own * width..][..width].copy_from_slice(action);
        }
        self.inner.observe(&mut self.observation, 0);
        let opponents = self.opponents.clone();
        for (index, opponent) in opponents.iter().enumerate() {
            let met = |env: &usize| opponents.index(self.bouts[*env].opponent) == index;
            let envs: Vec<usize> = (0..self.bouts.len()).filter(met).collect();
            if envs.is_empty() {
                continue;
            }
            let numbers: Vec<u32> = envs.iter().map(|&env| self.first + env as u32).collect();
            let (seed, now) = (self.seed ^ OPPONENT_SEED, self.step_counter);
            let actions = opponent.act(&self.seen_by_opponents(&envs), &numbers, seed, now);
            for (&env, action) in envs.iter().zip(actions.chunks_exact(width)) {
                let [_, other] = self.rows(env);
                self.action.host_mut()[other * width..][..width].copy_from_slice(action);
            }
        }
    }

    fn seen_by_opponents(&self, envs: &[usize]) -> Vec<f32> {
        let dim = self.spec.observation.dim();
        let row = |&env: &usize| {
            let [_, other] = self.rows(env);
            &self.observation.host()[other * dim..][..dim]
        };
        envs.iter().flat_map(row).copied().collect()
    }

    /// Hands over the learner's rows of a step.
    fn hand_over(&self, out: &mut Transition) {
        let (own, dim) = (&self.step, self.spec.observation.dim());
        let first = out.step * self.bouts.len();
        let final_row = self.spec.final_row(out.step);
        for env in 0..self.bouts.len() {
            let ([from, _], to) = (self.rows(env), first + env);
            out.reward.host_mut()[to] = own.reward.host()[from];
            out.style_reward.host_mut()[to] = own.style_reward.host()[from];
            out.termination.host_mut()[to] = own.termination.host()[from];
            out.group.host_mut()[to] = own.group.host()[from];
            if own.termination.host()[from] != RUNNING {
                let last = &own.final_observation.host()[from * dim..][..dim];
                let to = (final_row + env) * dim;
                out.final_observation.host_mut()[to..][..dim].copy_from_slice(last);
            }
        }
    }

    /// The sums of every inner row, `[2 envs][stats]`.
    fn row_stats(&self) -> Vec<f32> {
        let rows = 0..self.inner.spec().rows();
        rows.flat_map(|row| self.inner.row_stats(row))
            .copied()
            .collect()
    }

    /// Counts the bouts that have ended since the inner rows had the sums `before`, and draws those that begin.
    fn end_bouts(&mut self, before: &[f32]) {
        let (now, stats) = (self.row_stats(), self.sums.len());
        for env in 0..self.bouts.len() {
            let [own, other] = self.rows(env);
            if self.step.termination.host()[own] == RUNNING {
                continue;
            }
            let gained = |row: usize, stat: usize| {
                let at = row * stats + stat;
                now[at] - before[at]
            };
            let [won, lost] = [own, other].map(|row| gained(row, self.successes));
            for (stat, sum) in self.sums.iter_mut().enumerate() {
                *sum += gained(own, stat);
            }
            self.results.push(BoutResult {
                opponent: self.bouts[env].opponent,
                score: (0.5 * (1.0 + won - lost)).clamp(0.0, 1.0),
            });
            self.bouts[env] = self.draw(env);
        }
    }
}

/// An action at rest, `[action]`.
fn at_rest(envs: &dyn VecEnv) -> Vec<f32> {
    let mut action = envs.rest_action();
    action.resize(envs.spec().action, 0.0);
    action
}

impl VecEnv for SelfPlayEnv {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn rest_action(&self) -> Vec<f32> {
        self.inner.rest_action()
    }

    fn observe(&mut self, out: &mut Array, at: usize) {
        self.inner.observe(&mut self.observation, 0);
        let dim = self.spec.observation.dim();
        let rows = out.host_mut()[at..].chunks_exact_mut(dim);
        for (env, row) in rows.take(self.bouts.len()).enumerate() {
            let [own, _] = self.rows(env);
            row.copy_from_slice(&self.observation.host()[own * dim..][..dim]);
        }
    }

    fn step(&mut self, action: &Array, at: usize, mut out: Transition) {
        self.act(&action.host()[at..]);
        let before = self.row_stats();
        self.inner.step(&self.action, 0, self.step.transition());
        self.step_counter += 1;
        self.hand_over(&mut out);
        self.end_bouts(&before);
    }

    fn stat_names(&self) -> &'static [&'static str] {
        self.inner.stat_names()
    }

    fn stats(&mut self, out: &mut Array) {
        // The inner sums are of both agents; they are to begin anew.
        self.inner.stats(out);
        out.host_mut().copy_from_slice(&self.sums);
        self.sums.fill(0.0);
    }

    fn set_level(&mut self, level: u32) {
        self.inner.set_level(level);
    }

    fn live_view(&mut self) -> Result<Option<LiveView>> {
        self.inner.live_view()
    }

    fn contact_overflow(&self) -> Result<u64> {
        self.inner.contact_overflow()
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
        self.step_counter = from.get("bout_steps")?;
        self.sums = from.take_finite("bout_sums", self.sums.len())?;
        let bouts: Vec<[u32; 2]> = from.take_array("bouts", self.bouts.len())?;
        if bouts.iter().any(|&[agent, _]| agent > 1) {
            return Err(SectionError("a bout has more than two agents".into()));
        }
        let bout = |[agent, opponent]: [u32; 2]| Bout {
            agent: agent as usize,
            opponent,
        };
        self.bouts = bouts.into_iter().map(bout).collect();
        Ok(())
    }
}
