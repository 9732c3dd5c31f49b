//! How a foot moves: rolling over heel and ball in the stance, along an arc in the swing.
//!
//! The rule of contact: a foot lands (heel first going forward, ball first going backwards),
//! rolls flat within the first part of the stance, and from then to the stance's end its TOE
//! joint is fixed in the world: that part is flagged as planted. The heel lifts about the toe
//! joint before the foot leaves.

use super::ease::{bell, mix, smooth};
use super::figure::{FOOT_DROP, FOOT_LENGTH, HEEL, SOLE};
use super::footfall::{Stance, sideways};
use super::gait::running;
use super::track::Track;
use glam::{Quat, Vec3, vec3};

/// Seconds, at most, from the first touch to the flat foot.
const LANDING: f32 = 0.11;
/// Seconds, at most, from the heel's lifting to the toe's.
const PUSH: f32 = 0.26;
/// Heel to ball of the foot (m).
const SOLE_LENGTH: f32 = FOOT_LENGTH + HEEL;
/// The toes' dip while the heel is pulled up in the swing, walking and running (rad).
const TUCK: (f32, f32) = (0.12, 0.75);
/// The swinging foot passes the standing one at least this far to its side (m).
const PASS: f32 = 0.11;

/// A foot at one moment.
#[derive(Clone, Copy, Debug)]
pub struct FootState {
    pub ankle: Vec3,
    pub rotation: Quat,
    /// The toes' bend upwards against the foot (rad).
    pub bend: f32,
    /// 0 on the ground, where the leg must reach it, up to 1 midway through a swing.
    pub air: f32,
    /// Its toe joint is fixed in the world.
    pub planted: bool,
}

/// The pitch of a foot at both ends of its stance (rad): toes up is positive.
struct Roll {
    strike: f32,
    push: f32,
}

fn roll(track: &Track, stance: &Stance) -> Roll {
    let (touch, leave) = (track.at(stance.from), track.at(stance.to));
    let walk = 0.36 * (touch.ahead() / 1.3).clamp(-0.7, 1.0);
    let effort = (leave.ahead() / 1.3).clamp(0.0, 1.0);
    Roll {
        strike: mix(walk, 0.12, running(&touch)),
        push: -mix(0.2, mix(0.85, 0.9, running(&leave)), effort),
    }
}

/// The foot of `side` at `time`, from its stances and the other foot's.
pub fn foot(
    track: &Track,
    stances: &[Stance],
    others: &[Stance],
    side: usize,
    time: f32,
) -> FootState {
    let landed = stances.partition_point(|stance| stance.from <= time);
    let current = &stances[landed.max(1) - 1];
    match stances.get(landed) {
        Some(next) if time > current.to => {
            let midway = 0.5 * (current.to + next.from);
            let passed = others.partition_point(|stance| stance.from <= midway);
            let s = (time - current.to) / (next.from - current.to);
            let swing = Swing {
                before: current,
                after: next,
                passing: others[passed.max(1) - 1].place,
                side,
            };
            swing.at(track, s)
        }
        _ => stand(track, current, time),
    }
}

fn stand(track: &Track, stance: &Stance, time: f32) -> FootState {
    let roll = roll(track, stance);
    let length = stance.to - stance.from;
    let landing = LANDING.min(0.25 * length);
    let push = PUSH.min(0.5 * length);
    let down = 1.0 - smooth(0.0, 1.0, (time - stance.from) / landing);
    let up = ((time - stance.to + push) / push).clamp(0.0, 1.0);
    // Eased in only: the foot leaves the ground while still turning.
    let pitch = roll.strike * down + roll.push * up * up;
    FootState {
        planted: roll.strike <= 0.0 || down == 0.0,
        ..posed(stance.place, stance.yaw, pitch, 0.0, 0.0)
    }
}

/// A foot on its way from one stance to the next, beside the other foot.
struct Swing<'a> {
    before: &'a Stance,
    after: &'a Stance,
    passing: Vec3,
    side: usize,
}

impl Swing<'_> {
    /// The foot at share `s` of the swing.
    fn at(&self, track: &Track, s: f32) -> FootState {
        let (before, after) = (self.before, self.after);
        let way = smooth(0.0, 1.0, s);
        let yaw = mix(before.yaw, after.yaw, way);
        let place = before.place.lerp(after.place, way) + self.detour() * bell(s);

        let middle = track.at(0.5 * (before.to + after.from));
        let run = running(&middle);
        let (push, strike) = (roll(track, before).push, roll(track, after).strike);
        let tuck = mix(TUCK.0, TUCK.1, run) * smooth(0.0, 1.2, middle.ahead());
        // Both arcs culminate before midway: the foot is snatched up and set down gently.
        let pitch = mix(push, strike, smooth(0.0, 0.95, s)) - tuck * bell(s.powf(0.6));
        let height = self.clearance(run, middle.speed()) * bell(s.powf(0.85));
        posed(place, yaw, pitch, height, bell(s))
    }

    /// What keeps the straight way clear of the other foot.
    fn detour(&self) -> Vec3 {
        let half = self.before.place.lerp(self.after.place, 0.5);
        let outwards = sideways(mix(self.before.yaw, self.after.yaw, 0.5), self.side);
        let beside = (half - self.passing).dot(outwards);
        outwards * (PASS - beside).max(0.0)
    }

    /// How high the sole rises (m): a little more in a longer step, much more in a faster run.
    fn clearance(&self, run: f32, speed: f32) -> f32 {
        let length = self.before.place.distance(self.after.place);
        mix(0.03 + 0.05 * length.min(0.6), 0.06 + 0.055 * speed, run)
    }
}

/// A foot over `place` (its ball's, when flat), its sole's lowest point `height` metres up.
/// `air` (0..1) rounds the change between pivoting on the heel and on the ball.
pub fn posed(place: Vec3, yaw: f32, pitch: f32, height: f32, air: f32) -> FootState {
    let turn = Quat::from_rotation_y(yaw);
    let rotation = turn * Quat::from_rotation_x(-pitch);
    let width = 0.05 * air;
    let rise = SOLE_LENGTH * pitch.sin();
    let rise = 0.5 * (rise + rise.hypot(width));
    let back = SOLE_LENGTH * (pitch.max(0.0).cos() - 1.0);
    let toe = place + Vec3::Y * (SOLE + height + rise) + turn * vec3(0.0, 0.0, back);
    FootState {
        ankle: toe - rotation * vec3(0.0, -FOOT_DROP, FOOT_LENGTH),
        rotation,
        // On the ball the toes stay flat; in the air they follow the foot.
        bend: (-pitch).clamp(0.0, 0.9) * (1.0 - 0.8 * air),
        air,
        planted: false,
    }
}
