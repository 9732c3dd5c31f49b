//! What to do next: a random schedule of steps and punches.

use super::choreography::Choreography;
use super::punch::{PunchKind, PunchTarget, ThrownPunch};
use crate::motion::synthetic::random::Random;
use PunchKind::{Cross, Jab, LeftHook, RightHook};
use std::f32::consts::PI;

/// Seconds in guard before anything happens.
const LEAD_IN: f32 = 0.8;
/// The body gathers itself so long before the first fist sets off (s).
const GATHER: f32 = 0.18;
/// A fist may set off so long before the second foot of a step has landed (s).
const LANDING: f32 = 0.06;
/// Between two punches of one hand it rests in guard at least so long (s).
const PAUSE: f32 = 0.08;
/// Out of a punch of the other hand a hook has further to turn, and takes so much longer (s).
const FURTHER: f32 = 0.03;
/// How far to a side of straight ahead punches go, at most (m).
const ASIDE: f32 = 0.06;
/// Eight directions.
const EIGHTH: f32 = PI / 4.0;
/// What is thrown after one another.
const COMBINATIONS: [&[PunchKind]; 11] = [
    &[Jab, Cross],
    &[Jab, Cross],
    &[Jab, Jab],
    &[Jab, Cross, LeftHook],
    &[Jab, Cross, LeftHook],
    &[Cross, LeftHook],
    &[LeftHook, Cross],
    &[Jab, RightHook],
    &[LeftHook, RightHook],
    &[Jab, LeftHook],
    &[Jab, Cross, LeftHook, Cross],
];

/// A choreography of at least `seconds`, beginning in guard.
pub fn choreograph(random: &mut Random, seconds: f32) -> Choreography {
    let mut planner = Planner {
        random,
        now: LEAD_IN,
        plan: Choreography::in_guard(),
    };
    while planner.now < seconds {
        planner.act();
    }
    planner.plan
}

struct Planner<'a> {
    random: &'a mut Random,
    /// When the next action begins (s).
    now: f32,
    plan: Choreography,
}

impl Planner<'_> {
    /// One action, and a moment's rest.
    fn act(&mut self) {
        let lot = self.random.range(0.0, 1.0);
        match lot {
            _ if lot < 0.24 => self.step(),
            _ if lot < 0.33 => self.pivot(),
            _ if lot < 0.43 => self.approach(),
            _ if lot < 0.50 => self.evade(),
            _ if lot < 0.78 => {
                let kind = PunchKind::ALL[self.pick(PunchKind::ALL.len())];
                self.punches(&[kind]);
            }
            _ => {
                let combination = COMBINATIONS[self.pick(COMBINATIONS.len())];
                self.punches(combination);
            }
        }
        self.now += self.random.range(0.05, 0.55);
    }

    fn pick(&mut self, of: usize) -> usize {
        self.random.range(0.0, of as f32) as usize
    }

    /// One step in any direction.
    fn step(&mut self) {
        let bearing = EIGHTH * self.pick(8) as f32 + self.random.range(-0.2, 0.2);
        let length = self.random.range(0.14, 0.3);
        let turn = self.random.range(-0.2, 0.2);
        let swing = self.random.range(0.22, 0.28);
        self.steps(1, (bearing, length, turn), swing);
    }

    /// Closing the distance: quick steps forward.
    fn approach(&mut self) {
        let count = 3 + self.pick(5);
        let length = self.random.range(0.32, 0.38);
        let bearing = self.random.range(-0.15, 0.15);
        let turn = self.random.range(-0.06, 0.06);
        let swing = self.random.range(0.175, 0.195);
        self.steps(count, (bearing, length, turn), swing);
    }

    /// A few quick steps back or to a side.
    fn evade(&mut self) {
        let bearing = EIGHTH * (2 + self.pick(5)) as f32;
        let length = self.random.range(0.22, 0.3);
        let turn = self.random.range(-0.15, 0.15);
        let count = 2 + self.pick(2);
        self.steps(count, (bearing, length, turn), 0.21);
    }

    fn steps(&mut self, count: usize, step: (f32, f32, f32), swing: f32) {
        for _ in 0..count {
            self.plan.step(self.now, step, swing);
            self.now += 2.0 * swing;
        }
    }

    fn pivot(&mut self) {
        let turn = self.random.sign() * self.random.range(0.35, PI / 3.0);
        let seconds = 0.3 + 0.3 * turn.abs();
        self.plan.pivot(self.now, turn, seconds);
        self.now += seconds;
    }

    /// Punches, one after the other, sometimes with a step forward under the first.
    fn punches(&mut self, kinds: &[PunchKind]) {
        let mut start = self.now + GATHER;
        let mut free = [start; 2];
        if self.random.chance(0.35) {
            let swing = self.random.range(0.2, 0.23);
            let length = self.random.range(0.15, 0.3);
            self.plan.step(start, (0.0, length, 0.0), swing);
            // A jab flies with the step; the others have both feet on the ground behind them.
            let landed = start + 2.0 * swing - LANDING;
            free = [if kinds[0] == Jab { start } else { landed }, landed];
        }
        let mut target = self.target();
        for (index, &kind) in kinds.iter().enumerate() {
            let side = kind.side();
            let mut punch = self.punch(kind, target, start.max(free[side]));
            let before = index.checked_sub(1).map(|before| kinds[before].side());
            if kind.is_hook() && before == Some(1 - side) {
                punch.out += FURTHER;
            }
            self.plan.throw(punch);
            // The other hand follows while this one returns.
            let next = kinds.get(index + 1);
            if next.is_none_or(|next| next.side() == side) {
                self.plan.recover((punch.turn(), punch.end()));
            }
            free[side] = punch.end() + PAUSE;
            start = punch.turn() + self.random.range(0.03, 0.1);
            self.now = punch.end();
            if self.random.chance(0.25) {
                target = self.target();
            }
        }
    }

    fn target(&mut self) -> PunchTarget {
        if self.random.chance(0.3) {
            PunchTarget::Body
        } else {
            PunchTarget::Head
        }
    }

    fn punch(&mut self, kind: PunchKind, target: PunchTarget, start: f32) -> ThrownPunch {
        let random = &mut *self.random;
        let out = match kind {
            Jab => random.range(0.17, 0.19),
            Cross => random.range(0.205, 0.23),
            LeftHook => random.range(0.205, 0.225),
            RightHook => random.range(0.28, 0.31),
        };
        let back = random.range(0.3, 0.4);
        let height = match target {
            PunchTarget::Head if kind.is_hook() => random.range(1.36, 1.48),
            PunchTarget::Head => random.range(1.36, 1.54),
            PunchTarget::Body => random.range(0.98, 1.14),
        };
        let reach = match kind {
            Jab | Cross => random.range(0.955, 0.985),
            LeftHook | RightHook => random.range(0.38, 0.45),
        };
        ThrownPunch {
            kind,
            target,
            start,
            out,
            back,
            height,
            aside: random.range(-ASIDE, ASIDE),
            reach,
        }
    }
}
