//! The ways of the fists: from the guard to what they punch, and back.

use super::arms::{Fist, LENGTH};
use super::choreography::{CHEST_YAW, Choreography};
use super::curve::minimum_jerk;
use super::habits::Habits;
use super::punch::{PunchTarget, ThrownPunch};
use super::trunk::Trunk;
use crate::motion::synthetic::figure::SIDE;
use glam::{Quat, Vec3, vec3};

/// From the neck to the fists in guard: to the left, up, ahead (m).
const GUARD: [Vec3; 2] = [vec3(0.09, 0.04, 0.255), vec3(-0.085, 0.055, 0.165)];
/// How much the guard turns with the shoulders, as a share.
const GUARD_TURN: f32 = 0.2;
/// Directions in which elbows point, seen from the chest, of a left arm: in guard, in straight
/// punches, in hooks to the head and to the body.
const ELBOW_GUARD: Vec3 = vec3(0.3, -1.0, -0.1);
const ELBOW_STRAIGHT: Vec3 = vec3(0.6, -1.0, 0.0);
const ELBOW_HOOK: Vec3 = vec3(1.0, 0.3, -0.35);
const ELBOW_HOOK_LOW: Vec3 = vec3(0.9, -0.5, -0.45);
/// Where a left hook flies past, seen from the neck with the chest: to the head and to the body (m).
const AROUND: Vec3 = vec3(0.5, -0.06, -0.05);
const AROUND_LOW: Vec3 = vec3(0.49, -0.18, -0.04);
/// A hook of either hand ends so far beyond the middle (m).
const BEYOND: [f32; 2] = [0.22, 0.12];
/// Distance of whom a straight is aimed at (m).
const DISTANCE: f32 = 0.95;
/// A fist is fastest shortly before it hits: the later, the higher this is.
const WHIP: f32 = 1.5;
/// The palm turns down by so much in a straight and in a hook (rad).
const PRONATION: (f32, f32) = (1.3, 0.5);

/// A punch, and where its fist gets to, seen from the hips in the heading's frame.
pub struct Flight {
    pub punch: ThrownPunch,
    to: Vec3,
}

impl Flight {
    /// `trunk` is where it will be at the apex, `hips` their height then (m).
    pub fn aimed(punch: ThrownPunch, trunk: &Trunk, hips: f32) -> Flight {
        let side = punch.kind.side();
        let up = punch.height - hips;
        let to = if punch.kind.is_hook() {
            let aside = trunk.neck.x - SIDE[side] * BEYOND[side] + punch.aside;
            vec3(aside, up, trunk.neck.z + punch.reach)
        } else {
            let shoulder = trunk.shoulders[side];
            let way = vec3(punch.aside, up, DISTANCE) - shoulder;
            shoulder + way.normalize() * (LENGTH * punch.reach)
        };
        Flight { punch, to }
    }

    fn is_on(&self, side: usize, time: f32) -> bool {
        let punch = &self.punch;
        punch.kind.side() == side && punch.start < time && time < punch.end()
    }

    /// Where the fist is on its way, from 0 in guard to 1, and whether it comes back.
    fn progress(&self, time: f32) -> (f32, bool) {
        let punch = &self.punch;
        let out = ((time - punch.start) / punch.out).clamp(0.0, 1.0);
        let back = (time - punch.turn()) / punch.back;
        match back > 0.0 {
            true => (minimum_jerk(1.0 - back), true),
            false => (minimum_jerk(out.powf(WHIP)), false),
        }
    }

    fn at(&self, time: f32, guard: Vec3, trunk: &Trunk) -> Vec3 {
        let (s, returns) = self.progress(time);
        if returns || !self.punch.kind.is_hook() {
            return guard.lerp(self.to, s);
        }
        let around = match self.punch.target {
            PunchTarget::Head => AROUND,
            PunchTarget::Body => AROUND_LOW,
        };
        let around = trunk.neck + trunk.chest * sided(around, self.punch.kind.side());
        guard.lerp(around, s).lerp(around.lerp(self.to, s), s)
    }

    /// How far the elbow has taken the punch's direction: sooner than the fist gets there.
    fn elbow_share(&self, time: f32) -> f32 {
        let punch = &self.punch;
        let rise = minimum_jerk(1.2 * (time - punch.start) / punch.out);
        rise - minimum_jerk((time - punch.turn()) / punch.back)
    }

    fn elbow(&self) -> Vec3 {
        match (self.punch.kind.is_hook(), self.punch.target) {
            (false, _) => ELBOW_STRAIGHT,
            (true, PunchTarget::Head) => ELBOW_HOOK,
            (true, PunchTarget::Body) => ELBOW_HOOK_LOW,
        }
    }
}

/// How far each fist is out, from 0 to 1.
pub fn stretch(plan: &Choreography, time: f32) -> [f32; 2] {
    [0, 1].map(|side| {
        let punches = plan
            .punches
            .iter()
            .filter(|punch| punch.kind.side() == side);
        let out = punches.map(|punch| {
            minimum_jerk((time - punch.start) / punch.out)
                - minimum_jerk((time - punch.turn()) / punch.back)
        });
        out.sum()
    })
}

/// The fist of `side`: in guard, or on the flight that it is on.
pub fn fist(side: usize, flights: &[Flight], habits: &Habits, time: f32, trunk: &Trunk) -> Fist {
    let guard = guard(side, habits, time, trunk);
    let Some(flight) = flights.iter().find(|flight| flight.is_on(side, time)) else {
        return Fist {
            at: guard,
            elbow: trunk.chest * sided(ELBOW_GUARD, side),
            pronation: 0.0,
        };
    };
    let share = flight.elbow_share(time);
    let hook = flight.punch.kind.is_hook();
    Fist {
        at: flight.at(time, guard, trunk),
        elbow: trunk.chest * sided(ELBOW_GUARD.lerp(flight.elbow(), share), side),
        pronation: share * if hook { PRONATION.1 } else { PRONATION.0 },
    }
}

/// The guard hangs on the neck: it leans with the trunk, and turns a little with it.
fn guard(side: usize, habits: &Habits, time: f32, trunk: &Trunk) -> Vec3 {
    let apart = SIDE[side] * habits.apart;
    let drift = habits.drift(side, time);
    let from_neck = GUARD[side] + vec3(apart, habits.raised + drift, 0.7 * drift);
    let turned = Quat::from_rotation_y(GUARD_TURN * (trunk.yaw - CHEST_YAW));
    trunk.neck + trunk.lean * turned * from_neck
}

/// What is said of a left arm, for the arm of `side`.
fn sided(v: Vec3, side: usize) -> Vec3 {
    v * vec3(SIDE[side], 1.0, 1.0)
}
