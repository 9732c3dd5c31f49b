//! When the feet come down: stride timing from speed, as in people.

use super::ease::{mix, smooth};
use super::random::Random;
use super::track::{Moment, Track};
use crate::motion::RATE;

/// Below this speed (m/s) and turning rate (rad/s) the feet stay where they are.
const REST_SPEED: f32 = 0.1;
const REST_TURN: f32 = 0.35;
/// A foot further than this from where it would rest (m, rad) takes one more step.
const AWAY: f32 = 0.05;
const ASKEW: f32 = 0.25;
/// The first step out of standing takes at most this long (s).
const FIRST_STEP: f32 = 0.36;
/// Turning on the spot steps as quickly as walking that many metres a radian.
const TURNING_PACE: f32 = 0.8;
/// The feet prepare for the speed that they will carry this much later (s).
const FORESIGHT: f32 = 0.12;
/// Swings are neither snatched nor endless (s).
const SWING: (f32, f32) = (0.22, 0.55);

/// How much a gait is a run: 0 walking, 1 running.
pub fn running(moment: &Moment) -> f32 {
    smooth(1.95, 2.45, moment.speed())
}

/// Strides (two steps) a second.
fn cadence(moment: &Moment) -> f32 {
    let pace = moment
        .speed()
        .max(TURNING_PACE * moment.turn.abs())
        .min(2.6);
    let sideways = moment.aside().abs().min(1.2);
    let walk = 0.72 + 0.26 * pace + 0.35 * sideways;
    let run = 1.27 + 0.06 * moment.speed();
    mix(walk, run, running(moment))
}

/// Share of the stride that a foot spends on the ground.
fn duty(moment: &Moment) -> f32 {
    let walk = mix(0.66, 0.58, (moment.speed() / 2.0).min(1.0));
    let run = mix(0.37, 0.28, smooth(2.0, 4.5, moment.speed()));
    mix(walk, run, running(moment))
}

/// A foot comes down.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Seconds.
    pub time: f32,
    /// 0 left, 1 right.
    pub side: usize,
}

/// The rhythm of a take.
pub struct Rhythm {
    /// Steps taken, one value a frame: an even integer when the left foot comes down, an odd
    /// one when the right does. It rests while the feet do.
    pub phase: Vec<f32>,
    pub contacts: Vec<Contact>,
}

impl Rhythm {
    pub fn of(track: &Track, random: &mut Random) -> Rhythm {
        let mut walker = Walker {
            track,
            pace: Pace::Resting,
            phase: 0.0,
            contacts: Vec::new(),
        };
        let phase = (0..track.0.len())
            .map(|frame| walker.frame(frame as f32 / RATE, random))
            .collect();
        Rhythm {
            phase,
            contacts: walker.contacts,
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Pace {
    Resting,
    FirstStep,
    Stepping,
}

/// Counts the steps along a track.
struct Walker<'a> {
    track: &'a Track,
    pace: Pace,
    phase: f32,
    contacts: Vec<Contact>,
}

impl Walker<'_> {
    /// The phase at `time`; goes on to the next frame.
    fn frame(&mut self, time: f32, random: &mut Random) -> f32 {
        if self.pace == Pace::Resting && !at_rest(self.track, time + FORESIGHT) {
            self.set_off(time, random);
        }
        let phase = self.phase;
        if self.pace != Pace::Resting {
            self.advance(time);
        }
        phase
    }

    /// The resting phase is whole; make it the count before the foot that is to go first.
    fn set_off(&mut self, time: f32, random: &mut Random) {
        let side = leading_foot(&self.track.at(time + 0.3), random);
        let next = self.phase as usize + 1;
        self.phase += ((next + side) % 2) as f32;
        self.pace = Pace::FirstStep;
    }

    fn advance(&mut self, time: f32) {
        let mut rate = 2.0 * cadence(&self.track.at(time + FORESIGHT));
        if self.pace == Pace::FirstStep {
            rate = rate.max(1.0 / FIRST_STEP);
        }
        let before = self.phase;
        self.phase += rate / RATE;
        let landing = self.phase.floor();
        if landing == before.floor() {
            return;
        }
        self.contacts.push(Contact {
            time: time + (landing - before) / rate,
            side: landing as usize % 2,
        });
        if self.settled() {
            self.pace = Pace::Resting;
            self.phase = landing;
        } else {
            self.pace = Pace::Stepping;
        }
    }

    /// The body stands still for a while and the last two footfalls are where it wants them.
    fn settled(&self) -> bool {
        let &[.., before, last] = &self.contacts[..] else {
            return false;
        };
        let track = self.track;
        let still = (0..4).all(|k| at_rest(track, last.time + 0.15 * k as f32));
        let rest = track.at(last.time + REST_AFTER);
        let near = |contact: &Contact| {
            let under = track.at(contact.time + REST_AFTER);
            under.position.distance(rest.position) < AWAY && (under.yaw - rest.yaw).abs() < ASKEW
        };
        still && near(&before) && near(&last)
    }
}

/// A foot that comes down to stay belongs under where the body is this much later (s).
pub const REST_AFTER: f32 = 0.25;

fn at_rest(track: &Track, time: f32) -> bool {
    let moment = track.at(time);
    moment.speed() < REST_SPEED && moment.turn.abs() < REST_TURN
}

/// Out of standing, the foot on the side of the way goes first, so that legs never cross.
fn leading_foot(soon: &Moment, random: &mut Random) -> usize {
    let leftwards = soon.aside() + 0.3 * soon.turn;
    if leftwards.abs() > 0.1 {
        usize::from(leftwards < 0.0)
    } else {
        usize::from(random.chance(0.5))
    }
}

/// Seconds that the swing before a contact takes.
pub fn swing_time(track: &Track, contact: f32) -> f32 {
    let moment = track.at(contact - 0.2);
    ((1.0 - duty(&moment)) / cadence(&moment)).clamp(SWING.0, SWING.1)
}
