//! The humanoid posed: from what its parts should do in the world to the positions of its joints.

use super::error::{Result, RetargetError};
use super::limb::Bend;
use crate::physics::drive::rotation_vector;
use crate::physics::kinematics::store;
use crate::physics::model::{Joint, JointKind, Model};
use glam::{Mat3, Quat, Vec3};

/// What a frame asks of the humanoid, in the world; in pairs, the right one is first.
pub struct TargetPose {
    /// Between the hip joints, m.
    pub hips: Vec3,
    pub pelvis: Quat,
    pub torso: Quat,
    pub head: Quat,
    pub arms: [Bend; 2],
    pub legs: [Bend; 2],
    pub feet: [Quat; 2],
}

/// Two bodies with a hinge between them.
struct Limb<'a> {
    ball: &'a Joint,
    hinge: &'a Joint,
}

/// The joints of a humanoid; in pairs, the right one is first.
pub struct HumanoidJoints<'a> {
    model: &'a Model,
    pelvis: &'a Joint,
    torso: &'a Joint,
    head: &'a Joint,
    arms: [Limb<'a>; 2],
    legs: [Limb<'a>; 2],
    feet: [&'a Joint; 2],
}

impl<'a> HumanoidJoints<'a> {
    pub fn of(model: &'a Model) -> Result<HumanoidJoints<'a>> {
        let joint = |body: &str, kind| joint(model, body, kind);
        let limb = |upper, lower| -> Result<Limb> {
            Ok(Limb {
                ball: joint(upper, JointKind::Ball)?,
                hinge: joint(lower, JointKind::Hinge)?,
            })
        };
        Ok(HumanoidJoints {
            model,
            pelvis: joint("pelvis", JointKind::Free)?,
            torso: joint("torso", JointKind::Ball)?,
            head: joint("head", JointKind::Ball)?,
            arms: [
                limb("right_upper_arm", "right_lower_arm")?,
                limb("left_upper_arm", "left_lower_arm")?,
            ],
            legs: [
                limb("right_thigh", "right_shin")?,
                limb("left_thigh", "left_shin")?,
            ],
            feet: [
                joint("right_foot", JointKind::Ball)?,
                joint("left_foot", JointKind::Ball)?,
            ],
        })
    }

    /// From hip to ankle, m.
    pub fn leg(&self) -> f32 {
        let position = |joint: &Joint| self.model.bodies[joint.body].position.length();
        let [right, left] =
            [0, 1].map(|side| position(self.legs[side].hinge) + position(self.feet[side]));
        (right + left) / 2.0
    }

    /// `[positions]`
    pub fn positions(&self, figure: &TargetPose) -> Vec<f32> {
        let mut q = self.model.qpos0.clone();
        let hips = self
            .legs
            .iter()
            .map(|leg| self.model.bodies[leg.ball.body].position);
        let hips = hips.sum::<Vec3>() / 2.0;
        let root = figure.hips - figure.pelvis * hips;
        q[self.pelvis.q..][..3].copy_from_slice(&root.to_array());
        store(&mut q[self.pelvis.q + 3..], figure.pelvis.normalize());
        let torso = self.ball(self.torso, figure.pelvis, figure.torso, &mut q);
        self.ball(self.head, torso, figure.head, &mut q);
        for side in 0..2 {
            self.limb(&self.arms[side], torso, &figure.arms[side], &mut q);
            let shin = self.limb(&self.legs[side], figure.pelvis, &figure.legs[side], &mut q);
            self.ball(self.feet[side], shin, figure.feet[side], &mut q);
        }
        q
    }

    /// Turns a body on its parent, which is turned by `parent`, as far as its joint can go towards
    /// `wanted`. Returns how it is turned then.
    fn ball(&self, joint: &Joint, parent: Quat, wanted: Quat, q: &mut [f32]) -> Quat {
        let parent = parent * self.model.bodies[joint.body].rotation;
        let rotation = rotation_vector(parent.inverse() * wanted);
        let most = joint.range.map_or(f32::MAX, |[_, most]| most);
        let rotation = Quat::from_scaled_axis(rotation.clamp_length_max(most));
        store(&mut q[joint.q..], rotation);
        parent * rotation
    }

    /// Poses a limb; returns how its lower body is turned.
    fn limb(&self, limb: &Limb, parent: Quat, bend: &Bend, q: &mut [f32]) -> Quat {
        let lower = &self.model.bodies[limb.hinge.body];
        let [least, most] = limb.hinge.range.unwrap_or([-f32::MAX, f32::MAX]);
        // Which way the hinge can go further is the way a limb bends.
        let way = if most + least < 0.0 { -1.0 } else { 1.0 };
        let own = frame(lower.rotation * limb.hinge.axis * way, lower.position);
        let upper = self.ball(
            limb.ball,
            parent,
            frame(bend.hinge, bend.bone) * own.inverse(),
            q,
        );
        let angle = (way * bend.angle).clamp(least, most);
        q[limb.hinge.q] = angle;
        upper * lower.rotation * Quat::from_axis_angle(limb.hinge.axis, angle)
    }
}

/// The only joint of a body.
pub fn joint<'a>(model: &'a Model, body: &str, kind: JointKind) -> Result<&'a Joint> {
    let found = model.bodies.iter().find(|found| found.name == body);
    let joints = found.map_or(&[][..], |body| &model.joints[body.joints.clone()]);
    match joints {
        [joint] if joint.kind == kind => Ok(joint),
        _ => Err(RetargetError::Model {
            model: model.name.clone(),
            body: body.to_string(),
            kind: match kind {
                JointKind::Free => "single free",
                JointKind::Ball => "single ball",
                JointKind::Hinge => "single hinge",
            },
        }),
    }
}

/// Turns x and y to a hinge and to a bone across it.
fn frame(hinge: Vec3, bone: Vec3) -> Quat {
    let bone = bone.normalize();
    Quat::from_mat3(&Mat3::from_cols(hinge, bone, hinge.cross(bone)))
}
