//! Foot locking: a standing foot stays where it came down.

use super::contact::{FootContact, SolePoints};
use super::inertialize::InertializedOffset;
use glam::Vec3;
use std::f32::consts::PI;

/// A foot comes down at its shown position if that is no farther than this from the recorded one, m;
/// else it steps over there.
const NEAR: f32 = 0.35;
/// Frames that such a step takes.
const STEP: f32 = 3.0;
/// How high it rises, per metre of its way, and at most, m.
const LIFT: f32 = 0.3;
const HIGHEST: f32 = 0.12;
/// Frames until the correction of a released foot has decayed.
const RELEASE: f32 = 12.0;

/// One foot's lock.
#[derive(Clone, Debug, Default)]
pub struct FootLock {
    held: Option<Hold>,
    /// Added to the foot in the last frame and in the one before, m.
    corrections: [Vec3; 2],
    /// The decaying correction of a foot that was released, and frames since.
    release: InertializedOffset,
    age: f32,
}

/// A foot that stands, or steps to where it will.
#[derive(Clone, Copy, Debug)]
struct Hold {
    contact: FootContact,
    /// Position of the bearing point on the ground, m; its height is the recording's.
    position: Vec3,
    /// From there to its shown position.
    step: InertializedOffset,
    lift: f32,
    age: f32,
    /// Its last shown position, m.
    shown: Vec3,
}

impl FootLock {
    /// The correction of the foot's position in the next frame, m: `sole` is its position in the stitched
    /// motion, `recorded` that in the recording.
    pub fn next(&mut self, sole: &SolePoints, recorded: &SolePoints, contact: FootContact) -> Vec3 {
        self.age += 1.0;
        let correction = match (sole.point(contact), recorded.point(contact)) {
            (Some(point), Some(recorded)) => self.stand(point, recorded, contact),
            _ => self.rest(),
        };
        self.corrections = [correction, self.corrections[0]];
        correction
    }

    fn stand(&mut self, point: Vec3, recorded: Vec3, contact: FootContact) -> Vec3 {
        let near = |hold: &Hold| level(hold.position - recorded).length() <= NEAR;
        let held = self
            .held
            .filter(|hold| hold.contact == contact && near(hold));
        let mut hold = match held {
            Some(hold) => hold,
            None => self.come_down(point, recorded, contact),
        };
        let height = Vec3::Y * (recorded.y + hold.lift * (PI * (hold.age / STEP).min(1.0)).sin());
        let shown = hold.position + height + hold.step.at(hold.age, STEP);
        (hold.age, hold.shown) = (hold.age + 1.0, shown);
        self.held = Some(hold);
        shown - point
    }

    /// A foot comes down, or rolls from heel to toe, or the motion has jumped to one in which it stands
    /// elsewhere.
    fn come_down(&mut self, point: Vec3, recorded: Vec3, contact: FootContact) -> Hold {
        let shown = match self.held {
            Some(hold) if hold.contact == contact => hold.shown,
            _ => point + self.rest(),
        };
        let way = level(shown - recorded);
        let far = way.length() > NEAR;
        let position = level(if far { recorded } else { shown });
        Hold {
            contact,
            position,
            step: InertializedOffset {
                value: shown - position - Vec3::Y * recorded.y,
                ..InertializedOffset::default()
            },
            shown,
            lift: if far {
                (LIFT * way.length()).min(HIGHEST)
            } else {
                0.0
            },
            age: 0.0,
        }
    }

    /// The correction of a foot that is not held: the one it had when it was released, decaying.
    fn rest(&mut self) -> Vec3 {
        if self.held.take().is_some() {
            self.release = InertializedOffset {
                value: self.corrections[0],
                velocity: self.corrections[0] - self.corrections[1],
                acceleration: Vec3::ZERO,
            };
            self.age = 1.0;
        }
        self.release.at(self.age, RELEASE)
    }
}

fn level(v: Vec3) -> Vec3 {
    Vec3::new(v.x, 0.0, v.z)
}
