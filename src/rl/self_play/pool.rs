//! The opponents of a training, and how the learner fares against them.

use super::{Opponent, SelfPlay};
use crate::container::{Section, SectionError};
use crate::kernels::rng::uniform01;
use crate::nn::Policy;
use anyhow::Result;
use std::sync::Arc;

/// Least weight of an opponent that is to be drawn.
const LEAST_WEIGHT: f64 = 0.05;

/// An opponent, and the bouts against it, of which earlier ones count less.
#[derive(Clone)]
pub struct PoolMember {
    /// Number of the opponent, from 0 in the order of joining.
    pub id: u32,
    /// Who plays.
    pub opponent: Arc<Opponent>,
    /// Bouts.
    pub games: f64,
    /// Bouts that the learner won; a draw is half of one.
    pub wins: f64,
}

impl PoolMember {
    fn new(id: u32, opponent: Opponent) -> PoolMember {
        PoolMember {
            id,
            opponent: Arc::new(opponent),
            games: 0.0,
            wins: 0.0,
        }
    }

    /// How much it is to be drawn: the fraction of bouts that the learner does not win, or a little if it wins all: else
    /// nobody would find out that it has forgotten how. Who has not been met yet is drawn as if it always won.
    pub fn weight(&self) -> f64 {
        match self.games > 0.0 {
            true => (1.0 - self.wins / self.games).max(LEAST_WEIGHT),
            false => 1.0,
        }
    }
}

/// How a bout ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoutResult {
    /// Number of the opponent.
    pub opponent: u32,
    /// 1 for the learner's win, 0 for its loss, half for a draw.
    pub score: f32,
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
    pub fn end_update(&mut self, steps: usize, results: &[BoutResult]) {
        let kept = self.config.decay.powi(steps as i32);
        for member in &mut self.members {
            member.games *= kept;
            member.wins *= kept;
        }
        for result in results {
            let mut members = self.members.iter_mut();
            if let Some(member) = members.find(|member| member.id == result.opponent) {
                member.games += 1.0;
                member.wins += f64::from(result.score);
                self.games += 1;
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

    /// Puts back what [`Pool::save`] saved of a pool with the same scripts, of opponents that act on so many numbers by
    /// so many.
    ///
    /// # Errors
    /// It is not that, or of another pool.
    pub fn load(
        &mut self,
        from: &mut Section,
        observation: usize,
        action: usize,
    ) -> Result<(), SectionError> {
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
                _ => Arc::new(frozen(own, observation, action)?),
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
}

/// Reads a policy that acts on so many numbers by so many.
fn frozen(from: &mut Section, observation: usize, action: usize) -> Result<Opponent, SectionError> {
    let policy = Policy::load(from)?;
    match (policy.observation().dim(), policy.action()) == (observation, action) {
        true => Ok(Opponent::Frozen(Box::new(policy))),
        false => Err(SectionError(
            "an opponent is of environments with other dimensions".into(),
        )),
    }
}

/// The opponents who may be drawn while a rollout is played.
pub struct Opponents {
    members: Vec<PoolMember>,
    /// How many of them, the first, are scripted.
    scripted: usize,
    /// Fraction of the bouts against these.
    share: f64,
}

impl Opponents {
    /// One alone: the first of every pool.
    pub fn only(first: Opponent) -> Opponents {
        Opponents {
            members: vec![PoolMember::new(0, first)],
            scripted: 1,
            share: 1.0,
        }
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Opponent> {
        self.members.iter().map(|member| &*member.opponent)
    }

    /// The index of an opponent by its number; of the newest, if it has left.
    pub fn index(&self, id: u32) -> usize {
        let found = self.members.iter().position(|member| member.id == id);
        found.unwrap_or(self.members.len() - 1)
    }

    /// The number of the opponent that random `bits` draw: a scripted one or a policy, and of these by their weights.
    pub fn draw(&self, bits: u32) -> u32 {
        let (scripted, policies) = self.members.split_at(self.scripted);
        let share = match (scripted.is_empty(), policies.is_empty()) {
            (true, _) => 0.0,
            (_, true) => 1.0,
            _ => self.share,
        };
        let part = f64::from(uniform01(bits));
        match part < share {
            true => by_weight(scripted, part / share),
            false => by_weight(policies, (part - share) / (1.0 - share)),
        }
    }
}

/// The number of one of some opponents, who are not none, at a `part` of the sum of their weights.
fn by_weight(members: &[PoolMember], part: f64) -> u32 {
    let mut left = part * members.iter().map(PoolMember::weight).sum::<f64>();
    let drawn = members.iter().find(|member| {
        left -= member.weight();
        left < 0.0
    });
    drawn.unwrap_or(&members[members.len() - 1]).id
}
