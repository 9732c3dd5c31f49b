//! Where the feet stand and how they move over the ground.

use super::curve::{Curve, minimum_jerk};
use crate::motion::synthetic::ease::bell;
use crate::motion::synthetic::track::{heading, left};
use glam::{Vec3, vec3};

/// From the middle of the stance to the balls of the feet, to the left and ahead (m).
const PLACES: [(f32, f32); 2] = [(0.11, 0.21), (-0.15, -0.19)];
/// The feet's direction against the heading (rad): the right toes point outwards.
const YAWS: [f32; 2] = [-0.22, -0.72];
/// The rear heel is a little off the ground (rad).
const HEELS: [f32; 2] = [0.03, 0.12];
/// How high a sole rises in a step, and in a step of one more metre (m).
const CLEARANCE: (f32, f32) = (0.028, 0.05);
/// How much sooner the foot beside the way goes first than the one at its front.
const SIDEWAYS: f32 = 2.5;
/// How far behind the ball of a foot its load is (m).
const BEHIND: f32 = 0.05;
/// Seconds before a foot leaves when it begins to shed its load, and after that when it has none.
const SHED: (f32, f32) = (0.06, 0.04);

/// Where somebody stands, and which way they face.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stance {
    pub at: Vec3,
    pub yaw: f32,
}

impl Stance {
    /// Place of the ball of a foot.
    pub fn ball(&self, side: usize) -> Vec3 {
        self.at + self.off_middle(side)
    }

    /// From the middle of the stance to the ball of a foot.
    fn off_middle(&self, side: usize) -> Vec3 {
        let (aside, ahead) = PLACES[side];
        left(self.yaw) * aside + heading(self.yaw) * ahead
    }

    /// Direction of a foot (rad).
    pub fn foot_yaw(&self, side: usize) -> f32 {
        self.yaw + YAWS[side]
    }

    /// The stance so far away, in a direction against the one faced, and then turned.
    pub fn stepped(&self, bearing: f32, length: f32, turn: f32) -> Stance {
        Stance {
            at: self.at + heading(self.yaw + bearing) * length,
            yaw: self.yaw + turn,
        }
    }

    /// The stance turned about the ball of a foot.
    pub fn pivoted(&self, side: usize, turn: f32) -> Stance {
        let turned = Stance {
            yaw: self.yaw + turn,
            ..*self
        };
        Stance {
            at: self.ball(side) - turned.off_middle(side),
            ..turned
        }
    }
}

/// The foot nearest to where a step leads, in a direction against the one faced: it goes first, so
/// that feet never cross.
pub fn nearest_foot(bearing: f32) -> usize {
    let way = vec3(bearing.sin() * SIDEWAYS, 0.0, bearing.cos());
    let near = |side: usize| vec3(PLACES[side].0, 0.0, PLACES[side].1).dot(way);
    usize::from(near(1) > near(0))
}

/// A foot over the whole of a clip.
#[derive(Clone, Debug)]
pub struct Footing {
    x: Curve,
    z: Curve,
    /// Direction (rad).
    pub yaw: Curve,
    /// Lift of the heel (rad).
    pub heel: Curve,
    /// How far it is turned on its ball, and its heel lifted, by a punch (rad).
    driven: (f32, f32),
    swings: Vec<Swing>,
}

#[derive(Clone, Copy, Debug)]
struct Swing {
    from: f32,
    to: f32,
    clearance: f32,
}

impl Footing {
    pub fn standing(stance: &Stance, side: usize) -> Footing {
        let ball = stance.ball(side);
        Footing {
            x: Curve::resting_at(ball.x),
            z: Curve::resting_at(ball.z),
            yaw: Curve::resting_at(stance.foot_yaw(side)),
            heel: Curve::resting_at(HEELS[side]),
            driven: (0.0, 0.0),
            swings: Vec::new(),
        }
    }

    /// Steps to `ball`, then pointing to `yaw`.
    pub fn swing(&mut self, (from, to): (f32, f32), ball: Vec3, yaw: f32) {
        let way = ball - vec3(self.x.end(), 0.0, self.z.end());
        self.x.go((from, to), way.x);
        self.z.go((from, to), way.z);
        self.yaw.arrive((from, to), yaw + self.driven.0);
        self.swings.push(Swing {
            from,
            to,
            clearance: CLEARANCE.0 + CLEARANCE.1 * way.length(),
        });
    }

    /// Turns on its ball, and lifts its heel, so far from how it stands otherwise.
    pub fn drive(&mut self, span: (f32, f32), turn: f32, lift: f32) {
        self.yaw.go(span, turn - self.driven.0);
        self.heel.go(span, lift - self.driven.1);
        self.driven = (turn, lift);
    }

    /// Place of the ball of the foot, on the ground.
    pub fn ball(&self, time: f32) -> Vec3 {
        vec3(self.x.at(time), 0.0, self.z.at(time))
    }

    /// Height of the sole (m), and how much the foot is in the air: 0 on the ground, up to 1 midway
    /// through a step.
    pub fn lift(&self, time: f32) -> (f32, f32) {
        self.swing_at(time).map_or((0.0, 0.0), |swing| {
            let air = bell((time - swing.from) / (swing.to - swing.from));
            (swing.clearance * air, air)
        })
    }

    /// Whether the foot stands, its toe joint fixed in the world.
    pub fn is_planted(&self, time: f32) -> bool {
        self.swing_at(time).is_none()
    }

    fn swing_at(&self, time: f32) -> Option<&Swing> {
        let mut swings = self.swings.iter();
        swings.find(|swing| swing.from < time && time < swing.to)
    }

    /// The share of its load that a foot can bear: 1, and 0 in the air. It sheds the load, and takes
    /// it up, over the moments about its leaving and its landing.
    pub fn bearing(&self, time: f32) -> f32 {
        let swings = self.swings.iter().map(|swing| {
            let left = ramp(time - swing.from);
            let landed = ramp(time - swing.to);
            1.0 - left + landed
        });
        swings.product()
    }

    /// Where a loaded foot bears (m): behind its ball.
    pub fn centre(&self, time: f32) -> Vec3 {
        self.ball(time) - heading(self.yaw.at(time)) * BEHIND
    }
}

/// From 0 before a foot leaves or lands to 1 after it.
fn ramp(after: f32) -> f32 {
    minimum_jerk((after + SHED.0) / (SHED.0 + SHED.1))
}
