//! A learner whose policy joins the pool of its opponents when it wins.

use super::pool::{BoutResults, Pool};
use super::{Opponent, SelfPlay, SelfPlayEnv};
use crate::container::{Section, SectionError};
use crate::env::EnvBatch;
use crate::nn::Policy;
use crate::ranks::Ranks;
use crate::rl::{Algorithm, Iteration};
use anyhow::{Result, bail};
use std::any::Any;
use std::sync::Arc;

/// Any learner, in environments of self-play.
pub struct SelfPlayLearner {
    inner: Box<dyn Algorithm>,
    config: SelfPlay,
    pool: Pool,
    /// Who never leaves the pool.
    scripted: Vec<Opponent>,
    /// Steps of an update.
    rollout_length: usize,
    /// Names of metrics that are fractions of the episodes' steps, and of the statistics that count these steps.
    fractions: &'static [(&'static str, &'static str)],
}

impl SelfPlayLearner {
    /// A learner whose opponents are the `scripted` ones and, to begin with, its policy as it is now. Of the environments' statistics, `fractions` of the steps are told by other names.
    ///
    /// # Errors
    /// The environments are not of self-play, or the device was lost.
    pub fn new(
        inner: Box<dyn Algorithm>,
        config: &SelfPlay,
        envs: &EnvBatch,
        scripted: Vec<Opponent>,
        rollout_length: usize,
        fractions: &'static [(&'static str, &'static str)],
    ) -> Result<Self> {
        let of_self_play = |part: &dyn Any| part.is::<SelfPlayEnv>();
        if !envs.parts.iter().all(|part| of_self_play(&**part)) {
            bail!("a learner by self-play takes environments of self-play");
        }
        Ok(SelfPlayLearner {
            pool: Pool::new(config, scripted.clone(), inner.policy()?),
            config: *config,
            inner,
            scripted,
            rollout_length,
            fractions,
        })
    }

    /// The opponents.
    pub fn pool(&self) -> &Pool {
        &self.pool
    }

    /// The bouts of all ranks against each of the opponents.
    fn together(&self, ranks: &Ranks, own: &[BoutResults]) -> Vec<BoutResults> {
        let members = self.pool.members();
        let sum = |of: fn(&BoutResults) -> f32| {
            members.iter().map(move |member| {
                let own = own.iter().filter(|result| result.opponent == member.id);
                own.map(of).sum::<f32>()
            })
        };
        let games = sum(|result| result.games as f32);
        let wins = sum(|result| result.wins as f32);
        let mut sums: Vec<f32> = games.chain(wins).collect();
        ranks.sum(&mut sums);
        let (games, wins) = sums.split_at(members.len());
        let sums = members.iter().zip(games.iter().zip(wins));
        sums.map(|(member, (&games, &wins))| BoutResults {
            opponent: member.id,
            games: games as u32,
            wins: wins.into(),
        })
        .collect()
    }

    /// What there is to tell of an update, besides what the learner inside tells.
    fn metrics(&self, iteration: &Iteration) -> Vec<(&'static str, f64)> {
        let steps = iteration.stats.sum("steps");
        let fractions = self.fractions.iter().filter(|_| steps > 0.0);
        let fractions = fractions.map(|&(name, stat)| (name, iteration.stats.sum(stat) / steps));
        let win_rate = self.pool.win_rate().map(|rate| ("win_rate", rate));
        let counts = [
            ("pool_size", self.pool.members().len() as f64),
            ("pool_joined", self.pool.joined().into()),
        ];
        fractions.chain(win_rate).chain(counts).collect()
    }
}

/// The parts of a batch that are of self-play.
fn fighters(envs: &mut EnvBatch) -> impl Iterator<Item = &mut SelfPlayEnv> {
    envs.parts.iter_mut().filter_map(|part| {
        let part: &mut dyn Any = &mut **part;
        part.downcast_mut()
    })
}

impl Algorithm for SelfPlayLearner {
    fn iterate(&mut self, envs: &mut EnvBatch, steps: u64) -> Result<Iteration> {
        let opponents = Arc::new(self.pool.opponents());
        fighters(envs).try_for_each(|part| part.set_opponents(&opponents))?;
        let mut iteration = self.inner.iterate(envs, steps)?;
        let results: Result<Vec<Vec<BoutResults>>> =
            fighters(envs).map(SelfPlayEnv::take_results).collect();
        let results = self.together(&envs.ranks, &results?.concat());
        self.pool.end_update(self.rollout_length, &results);
        iteration.losses.extend(self.metrics(&iteration));
        if self.pool.is_due() {
            self.pool.admit(self.inner.policy()?);
        }
        Ok(iteration)
    }

    fn policy(&self) -> Result<Policy> {
        self.inner.policy()
    }

    fn start_from(&mut self, policy: &Policy, section: &mut Section) -> Result<(), SectionError> {
        self.inner.start_from(policy, section)?;
        // What it begins with may observe less than the policy of this training.
        let own = self.inner.policy();
        let own = own.map_err(|error| SectionError(error.to_string()))?;
        self.pool = Pool::new(&self.config, self.scripted.clone(), own);
        Ok(())
    }

    fn save(&self, to: &mut Section) -> Result<()> {
        let mut own = Section::default();
        self.pool.save(&mut own)?;
        to.put_section("pool", own);
        self.inner.save(to)
    }

    fn load(&mut self, from: &mut Section, policy: &Policy) -> Result<(), SectionError> {
        self.pool.load(&mut from.take_section("pool"))?;
        self.inner.load(from, policy)
    }
}
