//! The pelvis, and all above it, as the gait and the accelerations ask.

use super::ease::{mix, smooth};
use super::figure::*;
use super::footfall::strafe_twist;
use super::random::Random;
use super::track::{Moment, Track};
use glam::{Quat, Vec3};
use std::f32::consts::{PI, TAU};

/// Standard gravity (m/s2).
const GRAVITY: f32 = 9.81;
/// Height of the hips over the ground, standing and running (m).
const HEIGHT: (f32, f32) = (0.93, 0.885);
/// Bob of the hips, up and down from the mean, walking and running (m).
const BOB: (f32, f32) = (0.014, 0.036);
/// When in a step (0: a foot comes down) the hips are lowest, walking and running.
const LOWEST: (f32, f32) = (0.12, 0.32);
/// Sway of the hips towards the standing foot, walking and running (m).
const SWAY: (f32, f32) = (0.022, 0.01);
/// The hips' turning with the legs, walking and running (rad).
const HIPS_YAW: (f32, f32) = (0.1, 0.14);
/// The shoulders' turning against the legs, walking and running (rad).
const SHOULDERS_YAW: (f32, f32) = (0.1, 0.17);
/// The hips' drop on the side of the swinging leg, and how much of it the spine undoes (rad).
const DROP: (f32, f32) = (0.06, 0.05);
/// Forward pitch of the hips and of the spine on them, walking and running (rad).
const HIPS_PITCH: (f32, f32) = (0.03, 0.09);
const SPINE_PITCH: (f32, f32) = (0.02, 0.1);
/// Shares of the lean in the hips and in the spine; the rest is left to the legs.
const LEAN_HIPS: f32 = 0.45;
const LEAN_SPINE: f32 = 0.4;
/// Arms: swing from the shoulder and fold of the elbow, walking and running (rad).
const ARM_SWING: (f32, f32) = (0.38, 0.62);
const ELBOW: (f32, f32) = (0.3, 1.5);
/// Fold of the elbow, standing (rad).
const ELBOW_IDLE: f32 = 0.2;
/// Upper arms out from the body, and turned inwards, walking and running (rad).
const ARM_OUT: (f32, f32) = (0.14, 0.2);
const ARM_IN: (f32, f32) = (0.15, 0.35);
/// Somebody standing shifts the hips this far to either side (m) and breathes that often (Hz).
const SHIFT: f32 = 0.035;
const BREATHS: f32 = 0.26;
/// Share of the lean that balances an acceleration which the body shows.
const LEAN: f32 = 0.55;
/// The head looks where the body will face this much later (s), up to this far (rad).
const LOOK_AHEAD: f32 = 0.45;
const LOOK: f32 = 0.8;

/// Habits that differ from take to take, and the slow wandering of somebody standing.
pub struct Manner {
    drift: [f32; 4],
    arms: f32,
    bounce: f32,
}

impl Manner {
    pub fn draw(random: &mut Random) -> Manner {
        Manner {
            drift: [0.0; 4].map(|_: f32| random.range(0.0, TAU)),
            arms: random.range(0.85, 1.15),
            bounce: random.range(0.85, 1.15),
        }
    }

    /// A slow curve in -1..1, another one for every `channel` (0..3).
    fn wander(&self, channel: usize, time: f32) -> f32 {
        let at = |hertz: f32, shift: f32| (TAU * hertz * time + shift).sin();
        let (a, b) = (self.drift[channel], self.drift[(channel + 1) % 4]);
        0.6 * at(0.11, a) + 0.4 * at(0.23, b)
    }
}

/// What the body does at one frame, in the words that the joints need.
pub struct Bearing {
    moment: Moment,
    phase: f32,
    time: f32,
    /// 0 a walker's posture .. 1 a runner's.
    run: f32,
    /// 0 standing .. 1 in full gait.
    gait: f32,
    /// 1 forward, -1 backwards, times `gait`.
    stride: f32,
    /// Lean forward and to the left (rad).
    lean: (f32, f32),
    /// Where the head turns, against the heading (rad).
    look: f32,
}

impl Bearing {
    pub fn at(track: &Track, manner: &Manner, phase: f32, time: f32) -> Bearing {
        let moment = track.at(time);
        let speed = moment.speed();
        let gait = smooth(0.05, 1.1, speed);
        let lean = |along: Vec3| LEAN * (moment.acceleration.dot(along) / GRAVITY).atan();
        let glance = 0.35 * (1.0 - gait) * manner.wander(2, time);
        Bearing {
            moment,
            phase,
            time,
            run: smooth(1.6, 3.0, speed),
            gait,
            stride: gait * (moment.ahead() / speed.hypot(0.3)),
            lean: (lean(moment.forward()), lean(moment.left())),
            look: glance + (track.at(time + LOOK_AHEAD).yaw - moment.yaw).clamp(-LOOK, LOOK),
        }
    }

    /// The cosine of the stride (two steps), greatest `late` steps after the left foot's contact.
    fn swing(&self, late: f32) -> f32 {
        (PI * (self.phase - late)).cos()
    }

    fn idle(&self) -> f32 {
        1.0 - self.gait
    }

    /// Shift of the weight to the left, standing (m).
    fn shift(&self, manner: &Manner) -> f32 {
        SHIFT * self.idle() * manner.wander(0, self.time)
    }

    /// Position and rotation of the hips before the legs have their say.
    pub fn pelvis(&self, manner: &Manner) -> (Vec3, Quat) {
        let lowest = mix(LOWEST.0, LOWEST.1, self.run);
        let bob = self.gait * manner.bounce * mix(BOB.0, BOB.1, self.run);
        let height = mix(HEIGHT.0, HEIGHT.1, self.run)
            - bob * (TAU * (self.phase - lowest)).cos()
            - 0.006 * self.idle() * (1.0 + manner.wander(1, self.time));
        let sway = self.gait * mix(SWAY.0, SWAY.1, self.run) * self.swing(0.55);
        let shift = self.shift(manner);
        let position =
            self.moment.position + Vec3::Y * height + self.moment.left() * (sway + shift);

        let yaw = self.pelvis_yaw() + self.moment.yaw;
        let roll = DROP.0 * self.gait * self.swing(0.5) + 0.7 * shift - LEAN_HIPS * self.lean.1;
        let pitch = 0.03
            + self.stride * mix(HIPS_PITCH.0, HIPS_PITCH.1, self.run)
            + LEAN_HIPS * self.lean.0;
        (position, turned(yaw, roll, pitch))
    }

    /// Against the heading: the hip over the leading foot goes ahead.
    fn pelvis_yaw(&self) -> f32 {
        -self.stride * mix(HIPS_YAW.0, HIPS_YAW.1, self.run) * self.swing(0.0)
            + strafe_twist(&self.moment)
    }

    /// Writes the local rotations of everything above the hips into `pose`.
    pub fn upper(&self, manner: &Manner, pose: &mut [Quat]) {
        let shoulders =
            self.stride * mix(SHOULDERS_YAW.0, SHOULDERS_YAW.1, self.run) * self.swing(0.0)
                - 0.5 * strafe_twist(&self.moment);
        let yaw = shoulders - self.pelvis_yaw() + 0.15 * self.look;
        let shift = self.shift(manner);
        let roll = -DROP.1 * self.gait * self.swing(0.5) - 0.9 * shift - LEAN_SPINE * self.lean.1;
        let pitch = self.stride * mix(SPINE_PITCH.0, SPINE_PITCH.1, self.run)
            + LEAN_SPINE * self.lean.0
            - 0.02;
        let breath = 0.012 * (TAU * BREATHS * self.time).sin();
        for (joint, extra) in SPINE.into_iter().zip([0.0, 0.0, breath]) {
            pose[joint] = turned(yaw / 3.0, roll / 3.0, pitch / 3.0 - extra);
        }
        self.head(manner, yaw + self.pelvis_yaw(), roll, pitch, pose);
        for side in 0..2 {
            self.arm(manner, side, breath, pose);
        }
    }

    /// The head stays nearly level and looks into the turn.
    fn head(&self, manner: &Manner, chest_yaw: f32, roll: f32, pitch: f32, pose: &mut [Quat]) {
        let yaw = self.look - chest_yaw;
        let lean = (
            roll - LEAN_HIPS * self.lean.1,
            pitch + LEAN_HIPS * self.lean.0,
        );
        let nod = 0.04 * self.idle() * manner.wander(3, self.time) - 0.75 * lean.1;
        pose[NECK] = turned(0.4 * yaw, -0.35 * lean.0, 0.5 * nod + 0.08);
        pose[HEAD] = turned(0.6 * yaw, -0.4 * lean.0, 0.5 * nod - 0.08);
    }

    /// Arms swing against the legs; elbows fold with speed.
    fn arm(&self, manner: &Manner, side: usize, breath: f32, pose: &mut [Quat]) {
        let sign = SIDE[side];
        let opposite = -sign * self.swing(0.08);
        let ampler = manner.arms * (0.7 + 0.3 * (self.moment.speed() / 2.0).min(1.0));
        let swing = self.stride * ampler * mix(ARM_SWING.0, ARM_SWING.1, self.run) * opposite;
        let hang = 0.03 * self.idle() * manner.wander(side, self.time)
            - 0.08 * self.gait
            - 0.06 * self.run;
        let apart = mix(ARM_OUT.0, ARM_OUT.1, self.run) + 0.05 * self.idle();
        let fold = mix(mix(ELBOW_IDLE, ELBOW.0, self.gait), ELBOW.1, self.run)
            + (0.5 * swing).max(-0.3)
            + 0.1 * self.lean.0.abs();
        let inward = mix(ARM_IN.0, ARM_IN.1, self.run);
        pose[SHOULDER[side]] = Quat::from_rotation_z(sign * (0.6 * breath - 0.03));
        pose[ARM[side]] = Quat::from_rotation_x(-swing - hang)
            * Quat::from_rotation_z(sign * (apart - 0.5 * PI))
            * Quat::from_rotation_x(inward);
        pose[FORE_ARM[side]] = Quat::from_rotation_y(-sign * fold);
        pose[HAND[side]] = Quat::from_rotation_z(-sign * 0.1) * Quat::from_rotation_y(-sign * 0.15);
    }
}

/// Yaw about up, then roll (left side up), then pitch (forward).
fn turned(yaw: f32, roll: f32, pitch: f32) -> Quat {
    Quat::from_rotation_y(yaw) * Quat::from_rotation_z(roll) * Quat::from_rotation_x(pitch)
}
