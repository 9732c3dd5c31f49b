//! A recording of a person put into the humanoid.
//!
//! Skeletons differ in proportions, in the pose that their joints' zero stands for and in how joints'
//! axes lie. So nothing is taken from their zero pose but which way the trunk's axes point: limbs follow
//! the directions of the recorded bones, their twist the axis about which the recorded elbow or
//! knee bends ([`limb`]), feet their soles, found where they stand ([`sole`]).

mod anatomy;
mod error;
mod humanoid_joints;
mod limb;
mod recorded_frame;
mod sole;

use super::footing::Footing;
use super::model::Model;
use super::motion_clip::MotionClip;
use super::pose::Y_UP;
use crate::motion::clip::Clip;
use crate::motion::resample::resample;
use crate::motion::roles::Roles;
use crate::motion::units;
use anatomy::Anatomy;
pub use error::{Result, RetargetError};
use glam::Vec3;
pub(super) use humanoid_joints::joint;
use humanoid_joints::{HumanoidJoints, TargetPose};
use limb::Hinge;
use recorded_frame::RecordedFrame;
use sole::Sole;

/// The clip's motion in a humanoid: it begins above the origin and stands on the ground, lengths are
/// scaled as the legs' are. Joints stay within their ranges.
///
/// # Errors
/// A model without the humanoid's parts, a skeleton without elbows or knees, a clip of one frame.
pub fn retarget(clip: &Clip, roles: &Roles, model: &Model) -> Result<MotionClip> {
    let clip = resample(clip.clone());
    if clip.frames() < 2 {
        return Err(RetargetError::Short {
            clip: clip.name.clone(),
            frames: clip.frames(),
        });
    }
    let joints = HumanoidJoints::of(model)?;
    let anatomy = Anatomy::of(&clip.skeleton, roles)?;
    let scale = joints.leg() / units::leg(&clip.skeleton, roles);
    let frames: Vec<RecordedFrame> = (0..clip.frames())
        .map(|index| frame(&clip, index))
        .collect();
    let source = Source::of(anatomy, &frames);
    let start = source.hips(&frames[0]) * Vec3::new(1.0, 1.0, 0.0);
    let mut q = Vec::with_capacity(frames.len() * model.nq());
    for frame in &frames {
        let mut figure = source.figure(frame);
        figure.hips = (figure.hips - start) * scale;
        q.extend(joints.positions(&figure));
    }
    footing(model)?.stand(&mut q);
    Ok(MotionClip::new(&clip.name, model, clip.rate, q))
}

/// What a humanoid stands on.
pub(super) fn footing(model: &Model) -> Result<Footing<'_>> {
    Footing::of(model).ok_or_else(|| RetargetError::Feet {
        model: model.name.clone(),
    })
}

fn frame(clip: &Clip, index: usize) -> RecordedFrame {
    let (at, rotation) = clip.world(index);
    let z_up = Y_UP.inverse();
    RecordedFrame {
        at: at.into_iter().map(|at| z_up * at).collect(),
        rotation: rotation
            .into_iter()
            .map(|rotation| z_up * rotation)
            .collect(),
    }
}

/// A skeleton, and what its motion tells about it.
struct Source {
    anatomy: Anatomy,
    elbows: [Hinge; 2],
    knees: [Hinge; 2],
    soles: [Sole; 2],
}

impl Source {
    fn of(anatomy: Anatomy, frames: &[RecordedFrame]) -> Source {
        // An elbow bends the hanging arm forwards, a knee the leg backwards.
        let rest = |joint: usize, hinge: Vec3| {
            let axes = anatomy.axes;
            move |frame: &RecordedFrame| {
                let trunk = frame.rotation[joint] * axes;
                [trunk * Vec3::NEG_Z, trunk * hinge]
            }
        };
        let (arm, leg) = (
            rest(anatomy.chest, Vec3::NEG_Y),
            rest(anatomy.hips, Vec3::Y),
        );
        Source {
            elbows: anatomy.arms.map(|limb| Hinge::of(limb, frames, &arm)),
            knees: anatomy.legs.map(|limb| Hinge::of(limb, frames, &leg)),
            soles: anatomy.feet.map(|foot| Sole::of(foot, frames)),
            anatomy,
        }
    }

    fn hips(&self, frame: &RecordedFrame) -> Vec3 {
        let [right, left] = self.anatomy.legs.map(|leg| frame.at[leg.top]);
        (right + left) / 2.0
    }

    fn figure(&self, frame: &RecordedFrame) -> TargetPose {
        let trunk = |joint: usize| frame.rotation[joint] * self.anatomy.axes;
        TargetPose {
            hips: self.hips(frame),
            pelvis: trunk(self.anatomy.hips),
            torso: trunk(self.anatomy.chest),
            head: trunk(self.anatomy.head),
            arms: [0, 1].map(|side| self.elbows[side].bend(frame)),
            legs: [0, 1].map(|side| self.knees[side].bend(frame)),
            feet: [0, 1].map(|side| self.soles[side].rotation(frame)),
        }
    }
}
