//! What to do: a random schedule of commands, as if somebody kept changing their mind.

use super::random::Random;
use std::f32::consts::PI;

/// One order to the performer, in force for `seconds`.
#[derive(Clone, Copy, Debug)]
pub struct Command {
    pub seconds: f32,
    /// Metres a second.
    pub speed: f32,
    /// Direction of travel against the direction faced: 0 forward, positive to the left (rad).
    pub bearing: f32,
    /// A sudden change of the direction faced when the command is given (rad).
    pub face: f32,
    /// Steady change of the direction faced while it lasts (rad/s).
    pub turn: f32,
}

/// The sharpest curve run, as sideways acceleration (m/s2).
const CURVE: f32 = 7.0;
/// The quickest steady turn (rad/s): 190 degrees a second.
const FASTEST_TURN: f32 = 3.3;

/// Out of a run (m/s), the chance to be sent back the other way: it would be too rare otherwise.
const RUN: f32 = 3.0;
const TURN_BACK: f32 = 0.25;

const STAND: Command = Command {
    seconds: 1.0,
    speed: 0.0,
    bearing: 0.0,
    face: 0.0,
    turn: 0.0,
};

/// Commands for at least `seconds`, beginning at rest.
pub fn schedule(random: &mut Random, seconds: f32) -> Vec<Command> {
    let mut commands = Vec::new();
    let mut last = STAND;
    let mut total = 0.0;
    while total < seconds {
        commands.push(last);
        total += last.seconds;
        last = if last.speed > RUN && random.chance(TURN_BACK) {
            turn_back(random)
        } else {
            draw(random)
        };
    }
    commands
}

/// Straight on for at least so many seconds, from rest.
pub fn walk(seconds: f32, speed: f32) -> Vec<Command> {
    let walk = Command {
        seconds,
        speed,
        ..STAND
    };
    vec![walk]
}

/// The mix, weighted so that the time spent resembles recorded locomotion sets.
fn draw(random: &mut Random) -> Command {
    let lot = random.range(0.0, 1.0);
    match lot {
        _ if lot < 0.08 => stand(random),
        _ if lot < 0.11 => shuffle(random),
        _ if lot < 0.18 => turn_on_the_spot(random),
        _ if lot < 0.46 => travel(random, 0.4, 2.0),
        _ if lot < 0.55 => travel(random, 2.0, 3.2),
        _ if lot < 0.67 => travel(random, 3.4, 4.65),
        _ if lot < 0.78 => dash_elsewhere(random),
        _ if lot < 0.85 => sidestep(random),
        _ if lot < 0.92 => backwards(random),
        _ => diagonal(random),
    }
}

fn stand(random: &mut Random) -> Command {
    Command {
        seconds: random.range(1.5, 4.0),
        ..STAND
    }
}

/// A small adjusting step while standing.
fn shuffle(random: &mut Random) -> Command {
    Command {
        seconds: random.range(0.5, 0.8),
        speed: random.range(0.25, 0.5),
        bearing: random.range(-PI, PI),
        face: random.range(-0.5, 0.5),
        ..STAND
    }
}

fn turn_on_the_spot(random: &mut Random) -> Command {
    if random.chance(0.5) {
        Command {
            seconds: random.range(0.9, 1.6),
            face: random.sign() * random.range(0.7, PI),
            ..STAND
        }
    } else {
        Command {
            seconds: random.range(0.8, 2.0),
            turn: random.sign() * random.range(1.0, FASTEST_TURN),
            ..STAND
        }
    }
}

/// Forward, straight or along a curve, often after a change of direction.
fn travel(random: &mut Random, slowest: f32, fastest: f32) -> Command {
    let speed = random.range(slowest, fastest);
    let sharpest = (CURVE / speed).min(FASTEST_TURN);
    Command {
        seconds: random.range(0.8, 3.5),
        speed,
        face: if random.chance(0.3) {
            random.range(-1.6, 1.6)
        } else {
            0.0
        },
        turn: if random.chance(0.45) {
            random.range(-sharpest, sharpest)
        } else {
            0.0
        },
        ..STAND
    }
}

/// Told to go somewhere else at once, at any pace.
fn dash_elsewhere(random: &mut Random) -> Command {
    Command {
        seconds: random.range(1.2, 2.5),
        speed: random.range(1.0, 4.5),
        face: random.sign() * random.range(0.8, PI),
        ..STAND
    }
}

/// Running back, as in a shuttle run.
fn turn_back(random: &mut Random) -> Command {
    Command {
        seconds: random.range(1.6, 2.6),
        speed: random.range(3.0, 4.6),
        face: random.sign() * random.range(2.4, PI),
        ..STAND
    }
}

fn sidestep(random: &mut Random) -> Command {
    Command {
        seconds: random.range(0.8, 2.2),
        speed: random.range(0.4, 1.1),
        bearing: random.sign() * random.range(1.3, 1.8),
        turn: random.range(-0.5, 0.5),
        ..STAND
    }
}

fn backwards(random: &mut Random) -> Command {
    Command {
        seconds: random.range(0.8, 2.5),
        speed: random.range(0.4, 1.5),
        bearing: PI + random.range(-0.5, 0.5),
        turn: random.range(-0.8, 0.8),
        ..STAND
    }
}

fn diagonal(random: &mut Random) -> Command {
    Command {
        seconds: random.range(0.8, 2.2),
        speed: random.range(0.6, 2.2),
        bearing: random.sign() * random.range(0.4, 1.1),
        turn: random.range(-0.8, 0.8),
        ..STAND
    }
}
