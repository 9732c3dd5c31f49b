//! A recording of a person put into the humanoid.
//!
//! Skeletons differ in proportions, in the pose that their joints' zero stands for and in how joints'
//! axes lie. So nothing is taken from their zero pose but which way the trunk's axes point: limbs follow
//! the directions of the recorded bones, their twist the axis about which the recorded elbow or
//! knee bends ([`limb`]), feet their soles, found where they stand ([`sole`]).

mod anatomy;
mod humanoid_joints;
mod limb;
mod sole;

use super::humanoid;
use super::model::Model;
use super::motion_clip::MotionClip;
use crate::motion::clip::Clip;
use crate::motion::error as motion;
use crate::motion::resample::resample;
use crate::motion::roles::Roles;
use crate::motion::units;
use anatomy::Anatomy;
use glam::{Quat, Vec3};
use humanoid_joints::HumanoidJoints;
use limb::{Bend, Hinge};
use sole::Sole;

pub type Result<T> = std::result::Result<T, RetargetError>;

/// Why a recording cannot be put into a body.
#[derive(Debug, thiserror::Error)]
pub enum RetargetError {
    #[error(transparent)]
    Motion(#[from] motion::MotionError),
    #[error(
        "the model '{model}' has no {kind} joint on a body '{body}': recordings are for bodies like the \
         humanoid, whose parts are called {}", humanoid::BODIES.join(", ")
    )]
    Model {
        model: String,
        body: String,
        kind: &'static str,
    },
    #[error(
        "the feet of the model '{model}' have no geom that touches anything: give one to 'right_foot' or 'left_foot'"
    )]
    Feet { model: String },
    #[error("the clip '{clip}' has {frames} frames, but a motion needs at least 2")]
    Short { clip: String, frames: usize },
    #[error(
        "unknown skeleton: {problem}; its joints are {joints}. Give a roles file that names other joints"
    )]
    Skeleton { problem: String, joints: String },
}

/// Turns the recordings' axes, y up, z forward, to the bodies': z up, x forward.
const UPRIGHT: Quat = Quat::from_xyzw(0.5, 0.5, 0.5, 0.5);

/// A recorded frame: places (m) and turns of the skeleton's joints, z up.
struct Frame {
    at: Vec<Vec3>,
    rotation: Vec<Quat>,
}

/// What a frame asks of the humanoid, in the world. Of pairs, the right one is first.
struct TargetPose {
    /// Between the hip joints, m.
    hips: Vec3,
    pelvis: Quat,
    torso: Quat,
    head: Quat,
    arms: [Bend; 2],
    legs: [Bend; 2],
    feet: [Quat; 2],
}

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
    let frames: Vec<Frame> = (0..clip.frames())
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
    joints.stand(&mut q);
    Ok(MotionClip::new(&clip.name, model, clip.rate, q))
}

fn frame(clip: &Clip, index: usize) -> Frame {
    let (at, rotation) = clip.world(index);
    Frame {
        at: at.into_iter().map(|at| UPRIGHT * at).collect(),
        rotation: rotation
            .into_iter()
            .map(|rotation| UPRIGHT * rotation)
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
    fn of(anatomy: Anatomy, frames: &[Frame]) -> Source {
        // An elbow bends the hanging arm forwards, a knee the leg backwards.
        let rest = |joint: usize, hinge: Vec3| {
            let axes = anatomy.axes;
            move |frame: &Frame| {
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

    fn hips(&self, frame: &Frame) -> Vec3 {
        let [right, left] = self.anatomy.legs.map(|leg| frame.at[leg.top]);
        (right + left) / 2.0
    }

    fn figure(&self, frame: &Frame) -> TargetPose {
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
