//! Environments of two agents as environments of one, who plays against opponents.

use super::Opponent;
use super::batch_opponents::{BatchOpponents, NoiseKey};
use super::bouts::Bouts;
use super::opponents::Opponents;
use super::pool::BoutResults;
use crate::container::{Section, SectionError};
use crate::env::termination::RUNNING;
use crate::env::{EnvSpec, Transition, VecEnv};
use crate::gpu::{Array, Device};
use crate::kernels::self_play::end_bouts;
use crate::nn::rows;
use crate::rl::step_columns::StepColumns;
use anyhow::{Result, bail};
use std::sync::Arc;

/// Makes the opponents' noise another than the learner's.
const OPPONENT_SEED: u32 = 0x4f50_5053;

/// Environments of two agents, of which the learner plays one: either, by chance, drawn anew for every bout. The other
/// is played by an opponent that is drawn then, too. All of it happens where the environments are: on a GPU nothing is
/// copied to the host. Rewards, terminations, observations and statistics are the learner's.
///
/// A bout whose opponent has left the pool is played on by the newest.
pub struct SelfPlayEnv {
    device: Device,
    inner: Box<dyn VecEnv>,
    spec: EnvSpec,
    opponents: BatchOpponents,
    bouts: Bouts,
    /// Index of successes among the statistics.
    successes: usize,
    /// Sums of all inner rows, `[stats][2 envs]`, as they were when a bout ended last.
    row_stats: Array,
    /// What the inner environments observe now, `[2 envs][observation]`, and what their agents do.
    observation: Array,
    action: Array,
    step: StepColumns,
    seed: u32,
    /// Number of the first environment in the whole batch.
    first: u32,
    step_counter: u32,
}

impl SelfPlayEnv {
    /// Environments around those of two agents on `device`, of which the first has the number `first` in the whole
    /// batch. Their first opponent repeats the action at rest.
    ///
    /// # Errors
    /// They have other agents, or do not tell who wins; or the device has no room for them.
    pub fn new(
        mut inner: Box<dyn VecEnv>,
        device: &Device,
        first: usize,
        seed: u32,
    ) -> Result<SelfPlayEnv> {
        let (spec, names) = (*inner.spec(), inner.stat_names());
        let successes = names.iter().position(|name| *name == "successes");
        let (2, Some(successes), Some(row_stats)) = (spec.agents, successes, inner.row_stats())
        else {
            bail!("self-play takes environments of two agents that tell who wins");
        };
        let widths = [spec.observation.dim(), spec.action];
        let mut rest = inner.rest_action();
        rest.resize(spec.action, 0.0);
        let resting = Arc::new(Opponents::only(Opponent::repeating(rest)));
        let dims = [spec.envs, names.len()];
        let opponents = BatchOpponents::new(&resting, device, dims, widths)?;
        let params = end_bouts::Params {
            successes: successes as u32,
            first: first as u32,
            seed,
            step_counter: 0,
        };
        let mut observation = Array::zeroed(device, spec.rows() * widths[0]);
        inner.observe(&mut observation, 0);
        Ok(SelfPlayEnv {
            bouts: Bouts::new(device, &opponents.table.host, &params),
            opponents,
            successes,
            row_stats,
            observation,
            action: Array::zeroed(device, spec.rows() * spec.action),
            step: StepColumns::new(device, spec.rows(), widths[0]),
            spec: EnvSpec { agents: 1, ..spec },
            device: device.clone(),
            seed,
            first: first as u32,
            step_counter: 0,
            inner,
        })
    }

    /// The opponents of the bouts that begin from now on. Results that have not been taken are forgotten.
    ///
    /// # Errors
    /// They are not of one form, or the device has no room for them.
    pub fn set_opponents(&mut self, opponents: &Arc<Opponents>) -> Result<()> {
        self.opponents.set(opponents)?;
        self.bouts
            .clear_results(self.opponents.table.host.numbers.len());
        Ok(())
    }

    /// The bouts that have ended since the last call.
    ///
    /// # Errors
    /// The device was lost.
    pub fn take_results(&mut self) -> Result<Vec<BoutResults>> {
        let numbers = &self.opponents.table.host.numbers;
        let results = self.bouts.results(numbers)?;
        self.bouts.clear_results(numbers.len());
        Ok(results)
    }

    /// Counts the bouts that the step has ended, and draws those that begin.
    fn end_bouts(&mut self) {
        let ends = &self.step.termination;
        if let Array::Host(ends) = ends
            && ends.iter().all(|&end| end == RUNNING)
        {
            return;
        }
        let Some(now) = self.inner.row_stats() else {
            return;
        };
        let params = end_bouts::Params {
            successes: self.successes as u32,
            first: self.first,
            seed: self.seed,
            step_counter: self.step_counter,
        };
        let stats = [&now, &self.row_stats];
        self.bouts.end(&self.opponents.table, ends, stats, &params);
        self.row_stats = now;
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

    fn row_stats(&self) -> Option<Array> {
        // The inner rows are of both agents.
        None
    }

    fn restart(&mut self, which: &[bool]) -> Result<()> {
        // Who plays whom stays.
        self.inner.restart(which)?;
        self.inner.observe(&mut self.observation, 0);
        Ok(())
    }

    fn observe(&mut self, out: &mut Array, at: usize) {
        let dim = self.spec.observation.dim();
        let own = rows::gather(&self.device, &self.observation, dim, &self.bouts.own);
        rows::replace(&self.device, out, at, &own);
    }

    fn step(&mut self, action: &Array, at: usize, mut out: Transition) {
        let key = NoiseKey {
            first: self.first,
            seed: self.seed ^ OPPONENT_SEED,
            step_counter: self.step_counter,
        };
        let (bouts, observation) = (&self.bouts, &self.observation);
        self.opponents
            .act(bouts, observation, action, at, key, &mut self.action);
        self.inner.step(&self.action, 0, self.step.transition());
        self.inner.observe(&mut self.observation, 0);
        self.step_counter += 1;
        let own = self.step.gather(&self.device, &self.bouts.own);
        own.count(&self.device, &self.spec, 0, 1.0, &mut out);
        self.end_bouts();
    }

    fn stat_names(&self) -> &'static [&'static str] {
        self.inner.stat_names()
    }

    fn stats(&mut self, out: &mut Array) {
        // The inner sums are of both agents; they begin anew.
        self.inner.stats(out);
        self.row_stats = Array::zeroed(&self.device, self.row_stats.len());
        self.bouts.stats(out);
    }

    fn save(&self, to: &mut Section) -> Result<()> {
        let mut inner = Section::default();
        self.inner.save(&mut inner)?;
        to.put_section("inner", inner);
        to.put("bout_steps", self.step_counter);
        self.bouts.save(to)
    }

    fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        self.inner.load(&mut from.take_section("inner"))?;
        self.inner.observe(&mut self.observation, 0);
        if let Some(row_stats) = self.inner.row_stats() {
            self.row_stats = row_stats;
        }
        self.step_counter = from.get("bout_steps")?;
        self.bouts.load(from)
    }
}
