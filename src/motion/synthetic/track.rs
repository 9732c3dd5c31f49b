//! Where the body goes: commands followed by critically damped springs.

use super::plan::Command;
use crate::motion::RATE;
use glam::{Vec3, vec3};
use std::f32::consts::{PI, TAU};

/// Stiffness of both springs (rad/s). They are equal so that in a steady curve the velocity
/// lags behind its command as much as the heading does, and the body never slides outwards.
const STIFFNESS: f32 = 5.5;
/// What legs can push (m/s2).
const ACCELERATION: f32 = 6.5;
/// The quickest pivot (rad/s): 260 degrees a second.
const PIVOT: f32 = 4.5;
/// Change of the turning rate (rad/s2).
const PIVOT_ACCELERATION: f32 = 30.0;
/// Share of the requested speed that is given before the body has turned to its way.
const HESITATION: f32 = 0.4;
/// Nobody faces further away from where they still slide (rad) above this speed (m/s).
const SLIP: f32 = 1.2;
const SLIP_SPEED: f32 = 1.2;

/// The planned motion of the body over the ground at one moment, world axes, y = 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moment {
    /// m, m/s, m/s2.
    pub position: Vec3,
    pub velocity: Vec3,
    pub acceleration: Vec3,
    /// Heading (rad, unwrapped) and its rate (rad/s).
    pub yaw: f32,
    pub turn: f32,
}

impl Moment {
    pub fn speed(&self) -> f32 {
        self.velocity.length()
    }

    pub fn forward(&self) -> Vec3 {
        heading(self.yaw)
    }

    pub fn left(&self) -> Vec3 {
        left(self.yaw)
    }

    /// Velocity along the heading, negative backwards (m/s).
    pub fn ahead(&self) -> f32 {
        self.velocity.dot(self.forward())
    }

    /// Velocity to the left (m/s).
    pub fn aside(&self) -> f32 {
        self.velocity.dot(self.left())
    }
}

pub fn heading(yaw: f32) -> Vec3 {
    vec3(yaw.sin(), 0.0, yaw.cos())
}

pub fn left(yaw: f32) -> Vec3 {
    vec3(yaw.cos(), 0.0, -yaw.sin())
}

/// One moment a frame.
#[derive(Clone, Debug)]
pub struct Track(pub Vec<Moment>);

impl Track {
    pub fn follow(commands: &[Command], frames: usize) -> Track {
        let dt = 1.0 / RATE;
        let mut now = Moment::default();
        let mut requested = 0.0;
        let mut moments = Vec::with_capacity(frames);
        for command in commands {
            requested += command.face;
            for _ in 0..(command.seconds * RATE).round() as usize {
                moments.push(now);
                requested += command.turn * dt;
                now = advance(now, command, requested, dt);
            }
        }
        // Commands never fall short by more than their rounding: stay as it ends.
        moments.resize(frames, now);
        Track(moments)
    }

    /// The moment at `time` (s), linearly interpolated; the ends are held.
    pub fn at(&self, time: f32) -> Moment {
        let last = self.0.len() - 1;
        let frame = (time * RATE).clamp(0.0, last as f32);
        let index = (frame as usize).min(last.saturating_sub(1));
        let (a, b) = (&self.0[index], &self.0[(index + 1).min(last)]);
        let s = frame - index as f32;
        Moment {
            position: a.position.lerp(b.position, s),
            velocity: a.velocity.lerp(b.velocity, s),
            acceleration: a.acceleration.lerp(b.acceleration, s),
            yaw: a.yaw + (b.yaw - a.yaw) * s,
            turn: a.turn + (b.turn - a.turn) * s,
        }
    }
}

/// One frame of the springs towards `command`, facing `requested`.
fn advance(now: Moment, command: &Command, requested: f32, dt: f32) -> Moment {
    let aligned = (0.5 + 0.5 * (requested - now.yaw).cos()).max(HESITATION);
    let wanted = heading(requested + command.bearing) * (command.speed * aligned);
    let jerk = spring((wanted - now.velocity) * STIFFNESS, now.acceleration);
    let acceleration = (now.acceleration + jerk * dt).clamp_length_max(ACCELERATION);
    let velocity = now.velocity + acceleration * dt;

    let goal = facing_while_sliding(&now, command, requested);
    let twist = STIFFNESS * (STIFFNESS * (goal - now.yaw) - 2.0 * now.turn);
    let turn = now.turn + twist.clamp(-PIVOT_ACCELERATION, PIVOT_ACCELERATION) * dt;
    let turn = turn.clamp(-PIVOT, PIVOT);
    Moment {
        position: now.position + velocity * dt,
        velocity,
        acceleration,
        yaw: now.yaw + turn * dt,
        turn,
    }
}

fn spring(pull: Vec3, rate: Vec3) -> Vec3 {
    STIFFNESS * (pull - 2.0 * rate)
}

/// The requested heading, held back while the body still slides fast in another direction.
fn facing_while_sliding(now: &Moment, command: &Command, requested: f32) -> f32 {
    let speed = now.speed();
    if speed <= SLIP_SPEED {
        return requested;
    }
    let sliding = now.velocity.x.atan2(now.velocity.z) - command.bearing;
    let slip = requested - sliding;
    let wrapped = slip - TAU * (slip / TAU).round();
    let allowed = SLIP + PI * (2.0 - speed / SLIP_SPEED).max(0.0);
    let excess = wrapped - wrapped.clamp(-allowed, allowed);
    let to_go = requested - now.yaw;
    if excess * to_go < 0.0 {
        // The held-back heading lies behind: wait, never swing back the other way.
        now.yaw
    } else {
        now.yaw + (to_go.abs() - excess.abs()).max(0.0).copysign(to_go)
    }
}
