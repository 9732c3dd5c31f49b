//! The opponents of a training, and how the learner fares against them.

use super::opponents::{Opponents, PoolMember};
use super::{Opponent, SelfPlay};
use crate::container::{Section, SectionError};
use crate::nn::Policy;
use anyhow::Result;
use std::sync::Arc;

/// How bouts against an opponent ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoutResults {
    /// Number of the opponent.
    pub opponent: u32,
    /// Bouts.
    pub games: u32,
    /// Bouts that the learner won; a draw is half of one.
    pub wins: f64,
}

/// The opponents of a training.
pub struct Pool {
    config: SelfPlay,
    /// Those who never leave, then policies, the oldest first; never empty.
    members: Vec<PoolMember>,
    /// How many never leave.
    scripted: usize,
    /// Number of the next that joins.
    next: u32,
    /// Bouts since the last joined.
    games: u64,
    /// Updates since then.
    updates: u64,
}

impl Pool {
    /// A pool of opponents who never leave, and a first policy.
    pub fn new(config: &SelfPlay, scripted: Vec<Opponent>, first: Policy) -> Pool {
        let numbered = (0..).zip(scripted);
        let members: Vec<PoolMember> = numbered
            .map(|(id, opponent)| PoolMember::new(id, opponent))
            .collect();
        let mut pool = Pool {
            config: *config,
            scripted: members.len(),
            next: members.len() as u32,
            members,
            games: 0,
            updates: 0,
        };
        pool.admit(first);
        pool
    }

    /// The opponents: those who never leave, then policies, the oldest first.
    pub fn members(&self) -> &[PoolMember] {
        &self.members
    }

    /// How many have joined so far.
    pub fn joined(&self) -> u32 {
        self.next
    }

    /// Fraction of the bouts against all that the learner won.
    pub fn win_rate(&self) -> Option<f64> {
        let games: f64 = self.members.iter().map(|member| member.games).sum();
        let wins: f64 = self.members.iter().map(|member| member.wins).sum();
        (games > 0.0).then(|| wins / games)
    }

    /// Takes in the bouts that ended in an update of so many steps. Those against opponents that have left count for
    /// nothing.
    pub fn end_update(&mut self, steps: usize, results: &[BoutResults]) {
        let kept = self.config.decay.powi(steps as i32);
        for member in &mut self.members {
            member.games *= kept;
            member.wins *= kept;
        }
        for result in results {
            let mut members = self.members.iter_mut();
            if let Some(member) = members.find(|member| member.id == result.opponent) {
                member.games += f64::from(result.games);
                member.wins += result.wins;
                self.games += u64::from(result.games);
            }
        }
        self.updates += 1;
    }

    /// Whether a copy of the learner is to join.
    pub fn is_due(&self) -> bool {
        let SelfPlay {
            win_rate,
            games,
            updates,
            ..
        } = self.config;
        let wins = self.win_rate().is_some_and(|rate| rate > win_rate);
        let late = updates > 0 && self.updates >= updates;
        wins && self.games >= games || late
    }

    /// Lets a policy join, in the place of the oldest if there is no room.
    pub fn admit(&mut self, policy: Policy) {
        if self.members.len() - self.scripted >= self.config.pool.max(1) {
            self.members.remove(self.scripted);
        }
        let opponent = Opponent::Frozen(Box::new(policy));
        self.members.push(PoolMember::new(self.next, opponent));
        self.next += 1;
        (self.games, self.updates) = (0, 0);
    }

    /// Who may be drawn now.
    pub fn opponents(&self) -> Opponents {
        Opponents {
            members: self.members.clone(),
            scripted: self.scripted,
            share: self.config.scripted,
        }
    }

    /// Saves all of it but for the scripts.
    ///
    /// # Errors
    /// None: it is in host memory.
    pub fn save(&self, to: &mut Section) -> Result<()> {
        let ids: Vec<u32> = self.members.iter().map(|member| member.id).collect();
        let bouts = self
            .members
            .iter()
            .map(|member| [member.games, member.wins]);
        to.put("members", ids);
        to.put("scripted", self.scripted);
        to.put("since_last", [self.games, self.updates]);
        to.put("next", self.next);
        to.put_array("bouts", &bouts.collect::<Vec<_>>());
        for member in &self.members {
            if let Opponent::Frozen(policy) = &*member.opponent {
                let mut own = Section::default();
                policy.save(&mut own)?;
                to.put_section(&format!("member-{}", member.id), own);
            }
        }
        Ok(())
    }

    /// Puts back what [`Pool::save`] saved of a pool with the same scripts, and policies of the form of this one's.
    ///
    /// # Errors
    /// It is not that, or of another pool.
    pub fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        let ids: Vec<u32> = from.get("members")?;
        let (scripted, room) = (from.get::<usize>("scripted")?, self.config.pool);
        if scripted != self.scripted || !(1..=room).contains(&ids.len().saturating_sub(scripted)) {
            return Err(SectionError(format!(
                "its pool has {} members, {scripted} of them scripted: this one has {} of these, and room for {room} more",
                ids.len(),
                self.scripted
            )));
        }
        let bouts: Vec<[f64; 2]> = from.take_array("bouts", ids.len())?;
        if !bouts
            .as_flattened()
            .iter()
            .all(|sum| (0.0..=1e15).contains(sum))
        {
            return Err(SectionError("its pool's bouts are no counts".into()));
        }
        [self.games, self.updates] = from.get("since_last")?;
        self.next = from.get("next")?;
        let numbered = ids.windows(2).all(|pair| pair[0] < pair[1])
            && ids.iter().take(scripted).copied().eq(0..scripted as u32);
        let last = ids.last().is_some_and(|last| *last < self.next);
        let won = bouts.iter().all(|[games, wins]| wins <= games);
        if !(numbered && last && won && self.next < u32::MAX) {
            return Err(SectionError("its pool's members are no such".into()));
        }
        let members = ids.into_iter().zip(bouts).map(|(id, [games, wins])| {
            let own = &mut from.take_section(&format!("member-{id}"));
            let opponent = match self.members.get(id as usize) {
                Some(member) if (id as usize) < scripted => member.opponent.clone(),
                _ => Arc::new(self.frozen(own)?),
            };
            Ok(PoolMember {
                id,
                opponent,
                games,
                wins,
            })
        });
        self.members = members.collect::<Result<_, SectionError>>()?;
        Ok(())
    }

    /// Reads a policy of the form of those that there are.
    fn frozen(&self, from: &mut Section) -> Result<Opponent, SectionError> {
        let policy = Policy::load(from)?;
        let mut own = self
            .members
            .iter()
            .filter_map(|member| member.opponent.policy());
        match own.all(|own| policy.has_form_of(own)) {
            true => Ok(Opponent::Frozen(Box::new(policy))),
            false => Err(SectionError(
                "an opponent is of other networks, or of environments with other dimensions".into(),
            )),
        }
    }
}
