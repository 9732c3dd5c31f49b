//! The opponents who may be drawn while a rollout is played.

use super::Opponent;
use crate::kernels::self_play::OpponentTable;
use std::sync::Arc;

/// Least weight of an opponent that is to be drawn.
const LEAST_WEIGHT: f64 = 0.05;
/// What random numbers there are to draw one by.
const DRAWS: f64 = 16_777_216.0;

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
    pub(super) fn new(id: u32, opponent: Opponent) -> PoolMember {
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

/// The opponents who may be drawn while a rollout is played.
pub struct Opponents {
    /// Those who follow a script, then policies, the oldest first; not empty.
    pub(super) members: Vec<PoolMember>,
    /// How many of them follow a script.
    pub(super) scripted: usize,
    /// Fraction of the bouts against these.
    pub(super) share: f64,
}

impl Opponents {
    /// One alone, who follows a script: the first of every pool.
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

    /// Whether they are the same as these, one by one.
    pub fn are(&self, others: &Opponents) -> bool {
        let same =
            |(one, other): (&PoolMember, &PoolMember)| Arc::ptr_eq(&one.opponent, &other.opponent);
        self.members.len() == others.members.len()
            && self.members.iter().zip(&others.members).all(same)
    }

    /// Whom bouts are against in so many environments, with so many statistics: a scripted opponent or a policy, and of
    /// these by their weights.
    pub fn table(&self, envs: usize, stats: usize) -> OpponentTable {
        let (scripted, policies) = self.members.split_at(self.scripted);
        let share = match (scripted.is_empty(), policies.is_empty()) {
            (true, _) => 0.0,
            (_, true) => 1.0,
            _ => self.share,
        };
        let parts = [(scripted, 0.0, share), (policies, share, 1.0 - share)];
        let lots = parts.into_iter().flat_map(|(members, before, share)| {
            cumulated(members).map(move |part| before + share * part)
        });
        OpponentTable {
            envs,
            stats,
            scripted: self.scripted,
            numbers: self.members.iter().map(|member| member.id).collect(),
            lots: lots.map(|part| (part * DRAWS).ceil() as u32).collect(),
        }
    }
}

/// The part that each of some opponents and those before it have in the sum of their weights.
fn cumulated(members: &[PoolMember]) -> impl Iterator<Item = f64> {
    let all: f64 = members.iter().map(PoolMember::weight).sum();
    members.iter().scan(0.0, move |sum, member| {
        *sum += member.weight();
        Some(*sum / all)
    })
}
