//! Where the feet come down, and until when they stay.

use super::ease::{mix, smooth};
use super::figure::{FOOT_LENGTH, SIDE};
use super::gait::{Contact, REST_AFTER, Rhythm, running, swing_time};
use super::track::{Moment, Track, heading, left};
use crate::motion::RATE;
use glam::Vec3;

/// Sideways from the body to a foot, standing or walking and running (m).
const HALF_WIDTH: (f32, f32) = (0.095, 0.06);
/// Feet keep this far apart sideways (m): beside each other, and one well ahead of the other.
const APART: (f32, f32) = (0.13, 0.06);
/// Turning widens the stance by so many metres for each rad/s.
const OPEN: f32 = 0.015;
/// The widest that a foot is set to the side (m).
const WIDEST: f32 = 0.3;
/// Toes point outwards, walking and running (rad).
const TOE_OUT: (f32, f32) = (0.12, 0.04);
/// The ball of the foot lies ahead of the point that carries the body (m).
const BALL_AHEAD: f32 = 0.08;
/// How far the feet stay behind an accelerating body, metres for each m/s2. Balance asks for its
/// height over gravity, about 0.09; leaning does the other half.
const BALANCE: f32 = 0.045;
/// The furthest that a foot lands from the body, and that it is left behind (m).
const REACH: f32 = 0.4;
const LEAVE: f32 = 0.53;
/// Strides a second of a brisk sidestep.
const SHUFFLES: f32 = 1.3;
/// The shortest stance (s).
const STANCE: f32 = 0.1;

/// One foot on the ground.
#[derive(Clone, Copy, Debug)]
pub struct Stance {
    /// Seconds, from the first touch of the ground to the last.
    pub from: f32,
    pub to: f32,
    /// The ball of the foot over the ground, and the foot's direction (rad).
    pub place: Vec3,
    pub yaw: f32,
}

/// The stances of each foot in order of time; the first and the last reach beyond the take.
pub fn stances(track: &Track, rhythm: &Rhythm) -> [Vec<Stance>; 2] {
    let start = track.at(0.0);
    let mut feet = [0, 1].map(|side| vec![stand(&start, side)]);
    for (index, contact) in rhythm.contacts.iter().enumerate() {
        let next = rhythm.contacts[index + 1..]
            .iter()
            .find(|later| later.side == contact.side);
        let planned = next.map_or(f32::INFINITY, |next| {
            (next.time - swing_time(track, next.time)).max(contact.time + STANCE)
        });
        let other = feet[1 - contact.side].last().copied();
        let stance = land(track, contact, planned, other);
        let foot = &mut feet[contact.side];
        if let Some(last) = foot.last_mut().filter(|last| last.to.is_infinite()) {
            // Only the stance before the first contact does not know its end yet.
            last.to = contact.time - swing_time(track, contact.time);
        }
        foot.push(stance);
    }
    feet
}

/// Standing since long before the take.
fn stand(moment: &Moment, side: usize) -> Stance {
    Stance {
        from: -1.0,
        to: f32::INFINITY,
        place: moment.position + beside(moment, side) + moment.forward() * BALL_AHEAD,
        yaw: foot_yaw(moment, side),
    }
}

/// Plans the stance that `contact` begins and that may last until `planned`.
fn land(track: &Track, contact: &Contact, planned: f32, other: Option<Stance>) -> Stance {
    let touch = track.at(contact.time);
    let bias = mix(0.5, 0.42, running(&touch));
    let middle = contact.time + (bias * (planned - contact.time)).min(REST_AFTER);
    let under = track.at(middle);
    let mut place = under.position - under.acceleration * BALANCE
        + beside(&under, contact.side)
        + heading(under.yaw) * BALL_AHEAD;
    let yaw = foot_yaw(&under, contact.side);
    if let Some(other) = other {
        let ankle = FOOT_LENGTH * (heading(other.yaw) - heading(yaw));
        let balls = place - other.place;
        let outwards =
            room(balls, &touch, contact.side).max(room(balls + ankle, &touch, contact.side));
        place += sideways(touch.yaw, contact.side) * outwards;
    }
    let ahead = BALL_AHEAD * touch.forward();
    place = touch.position + ahead + (place - touch.position - ahead).clamp_length_max(REACH);
    Stance {
        from: contact.time,
        to: leave(track, contact.time, planned, place),
        place,
        yaw,
    }
}

/// From the body to the foot, sideways. A sidestep's leading foot must land so far out that
/// the trailing one fits beside it: a quarter of the stride and half a foot's room.
fn beside(moment: &Moment, side: usize) -> Vec3 {
    let narrow = mix(HALF_WIDTH.0, HALF_WIDTH.1, running(moment));
    let quarter_stride = moment.aside().abs() / (4.0 * SHUFFLES);
    let wide = (quarter_stride + APART.0 / 2.0).min(WIDEST);
    let turning = OPEN * moment.turn.abs() * (1.0 - running(moment));
    sideways(moment.yaw, side) * (wide.max(narrow) + turning)
}

/// How far outwards (m) a foot must move whose ball or ankle, `from_other` away from the other
/// foot's, would come down across or on it.
fn room(from_other: Vec3, touch: &Moment, side: usize) -> f32 {
    let stride = from_other.dot(touch.forward()).abs();
    let apart = mix(APART.0, APART.1, smooth(0.15, 0.35, stride));
    (apart - from_other.dot(sideways(touch.yaw, side))).max(0.0)
}

/// The end of a stance: as planned, or when the body has gone too far from the foot.
fn leave(track: &Track, from: f32, planned: f32, place: Vec3) -> f32 {
    let end = track.0.len() as f32 / RATE;
    let mut time = from + STANCE;
    while time < planned.min(end) {
        if track.at(time).position.distance(place) > LEAVE {
            return time;
        }
        time += 1.0 / RATE;
    }
    planned
}

fn foot_yaw(moment: &Moment, side: usize) -> f32 {
    let out = mix(TOE_OUT.0, TOE_OUT.1, running(moment));
    moment.yaw + SIDE[side] * out + strafe_twist(moment)
}

/// Walking diagonally, hips and feet turn towards the line of travel, at most this far (rad).
const TWIST: f32 = 0.3;

pub fn strafe_twist(moment: &Moment) -> f32 {
    let speed = moment.speed();
    TWIST * 2.0 * moment.aside() * moment.ahead() / (speed * speed + 0.5)
}

/// Outwards from the body, for the foot of `side`, facing `yaw`.
pub fn sideways(yaw: f32, side: usize) -> Vec3 {
    left(yaw) * SIDE[side]
}
