//! How an arm or a leg is held: which way its upper bone points, about which axis and how far it bends.

use super::anatomy::Limb;
use super::recorded_frame::RecordedFrame;
use glam::{Quat, Vec3};

/// The bend of a limb in one frame, in the world.
#[derive(Clone, Copy, Debug)]
pub struct Bend {
    /// Direction of the upper bone.
    pub bone: Vec3,
    /// About which the lower bone turns away from it; across the upper bone.
    pub hinge: Vec3,
    /// rad
    pub angle: f32,
}

/// A limb whose hinge has been found.
#[derive(Clone, Copy, Debug)]
pub struct Hinge {
    limb: Limb,
    /// In the frame of the upper bone, across it.
    axis: Vec3,
}

/// How little a limb's rest tells of its hinge, against the sine of the angle that it bends by.
const REST: f32 = 0.01;

/// How much the axis found over the clip tells, against the same, while a limb is straight.
const STRAIGHT: f32 = 0.3;

impl Hinge {
    /// The mean axis of the clip's bends. A limb that never bends has the one that `rest`, the direction
    /// in which the limb hangs and the axis that its hinge has then, turns to on the shortest way.
    pub fn of(
        limb: Limb,
        frames: &[RecordedFrame],
        rest: &impl Fn(&RecordedFrame) -> [Vec3; 2],
    ) -> Hinge {
        let seen = frames.iter().map(|frame| {
            let [down, hinge] = rest(frame);
            let [upper, lower] = limb.bones(frame);
            let hinge = Quat::from_rotation_arc(down, upper) * hinge;
            frame.rotation[limb.top].inverse() * (upper.cross(lower) + REST * hinge)
        });
        let axis = seen.sum::<Vec3>().reject_from(limb.upper);
        Hinge {
            limb,
            axis: axis
                .try_normalize()
                .unwrap_or(limb.upper.any_orthonormal_vector()),
        }
    }

    /// The bend that brings the lower bone where it was recorded. The straighter a limb, the more its
    /// hinge is where it is found over the whole clip, so that it never jumps.
    pub fn bend(&self, frame: &RecordedFrame) -> Bend {
        let [bone, lower] = self.limb.bones(frame);
        let usual = frame.rotation[self.limb.top] * self.axis;
        let across = bone.cross(lower);
        let along = across.dot(usual);
        let trust = STRAIGHT * (1.0 - across.length());
        // A limb that is bent the wrong way, by a little, is straight.
        let hinge = across + usual * (along.max(0.0) - along + trust);
        let hinge = hinge.try_normalize().unwrap_or(usual);
        Bend {
            bone,
            hinge,
            angle: across.dot(hinge).atan2(bone.dot(lower)).max(0.0),
        }
    }
}

impl Limb {
    /// Directions of the bones in the world.
    fn bones(&self, frame: &RecordedFrame) -> [Vec3; 2] {
        [
            frame.rotation[self.top] * self.upper,
            frame.rotation[self.middle] * self.lower,
        ]
    }
}
