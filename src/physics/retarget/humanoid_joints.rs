//! The humanoid posed: from what its parts should do in the world to the positions of its joints.

use super::limb::Bend;
use super::{Error, Figure, Result};
use crate::physics::drive::rotation_vector;
use crate::physics::kinematics::{kinematics, store};
use crate::physics::model::{Geom, Joint, Kind, Model, Shape};
use crate::physics::pose::Pose;
use crate::physics::spatial::Spatial;
use glam::{Mat3, Quat, Vec3};

/// Share of the frames whose feet may be below the ground.
const BELOW: f32 = 0.01;

/// Two bodies with a hinge between them.
struct Limb<'a> {
    ball: &'a Joint,
    hinge: &'a Joint,
}

/// The joints of a humanoid. Of pairs, the right one is first.
pub struct Puppet<'a> {
    model: &'a Model,
    pelvis: &'a Joint,
    torso: &'a Joint,
    head: &'a Joint,
    arms: [Limb<'a>; 2],
    legs: [Limb<'a>; 2],
    feet: [&'a Joint; 2],
}

impl<'a> Puppet<'a> {
    pub fn of(model: &'a Model) -> Result<Puppet<'a>> {
        let joint = |body: &str, kind| joint(model, body, kind);
        let limb = |upper, lower| -> Result<Limb> {
            Ok(Limb {
                ball: joint(upper, Kind::Ball)?,
                hinge: joint(lower, Kind::Hinge)?,
            })
        };
        let puppet = Puppet {
            model,
            pelvis: joint("pelvis", Kind::Free)?,
            torso: joint("torso", Kind::Ball)?,
            head: joint("head", Kind::Ball)?,
            arms: [
                limb("right_upper_arm", "right_lower_arm")?,
                limb("left_upper_arm", "left_lower_arm")?,
            ],
            legs: [
                limb("right_thigh", "right_shin")?,
                limb("left_thigh", "left_shin")?,
            ],
            feet: [
                joint("right_foot", Kind::Ball)?,
                joint("left_foot", Kind::Ball)?,
            ],
        };
        if puppet.soles().next().is_none() {
            let model = model.name.clone();
            return Err(Error::Feet { model });
        }
        Ok(puppet)
    }

    /// From hip to ankle, m.
    pub fn leg(&self) -> f32 {
        let place = |joint: &Joint| self.model.bodies[joint.body].place.length();
        let [right, left] =
            [0, 1].map(|side| place(self.legs[side].hinge) + place(self.feet[side]));
        (right + left) / 2.0
    }

    /// `[positions]`
    pub fn positions(&self, figure: &Figure) -> Vec<f32> {
        let mut q = self.model.start.clone();
        let hips = self
            .legs
            .iter()
            .map(|leg| self.model.bodies[leg.ball.body].place);
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
        let parent = parent * self.model.bodies[joint.body].turn;
        let turn = rotation_vector(parent.inverse() * wanted);
        let most = joint.range.map_or(f32::MAX, |[_, most]| most);
        let turn = Quat::from_scaled_axis(turn.clamp_length_max(most));
        store(&mut q[joint.q..], turn);
        parent * turn
    }

    /// Poses a limb; returns how its lower body is turned.
    fn limb(&self, limb: &Limb, parent: Quat, bend: &Bend, q: &mut [f32]) -> Quat {
        let lower = &self.model.bodies[limb.hinge.body];
        let [least, most] = limb.hinge.range.unwrap_or([-f32::MAX, f32::MAX]);
        // Which way the hinge can go further is the way a limb bends.
        let way = if most + least < 0.0 { -1.0 } else { 1.0 };
        let own = frame(lower.turn * limb.hinge.axis * way, lower.place);
        let upper = self.ball(
            limb.ball,
            parent,
            frame(bend.hinge, bend.bone) * own.inverse(),
            q,
        );
        let angle = (way * bend.angle).clamp(least, most);
        q[limb.hinge.q] = angle;
        upper * lower.turn * Quat::from_axis_angle(limb.hinge.axis, angle)
    }

    /// Puts the feet of `q`, `[frame][positions]`, on the ground: all but the lowest few.
    pub fn stand(&self, q: &mut [f32]) {
        let width = self.model.positions();
        let mut poses = vec![Pose::default(); self.model.bodies.len()];
        let mut axes = vec![Spatial::ZERO; self.model.velocities()];
        let mut heights: Vec<f32> = q
            .chunks_exact(width)
            .map(|q| {
                kinematics(self.model, q, &mut poses, &mut axes);
                self.lowest(&poses)
            })
            .collect();
        let below = (BELOW * heights.len() as f32) as usize;
        let (_, &mut ground, _) = heights.select_nth_unstable_by(below, f32::total_cmp);
        for q in q.chunks_exact_mut(width) {
            q[self.pelvis.q + 2] -= ground;
        }
    }

    /// What the feet can touch the ground with.
    fn soles(&self) -> impl Iterator<Item = &Geom> {
        let of = |geom: &&Geom| self.feet.iter().any(|foot| geom.body == Some(foot.body));
        self.model.geoms.iter().filter(of)
    }

    /// Height of the lowest point of the feet, m.
    fn lowest(&self, poses: &[Pose]) -> f32 {
        let heights = self.soles().map(|geom| {
            let pose = geom.pose(poses);
            lowest(geom.shape, pose.place, pose.turn)
        });
        heights.fold(f32::INFINITY, f32::min)
    }
}

fn joint<'a>(model: &'a Model, body: &str, kind: Kind) -> Result<&'a Joint> {
    let found = model.bodies.iter().find(|found| found.name == body);
    let joints = found.map_or(&[][..], |body| &model.joints[body.joints.clone()]);
    match joints {
        [joint] if joint.kind == kind => Ok(joint),
        _ => Err(Error::Model {
            model: model.name.clone(),
            body: body.to_string(),
            kind: match kind {
                Kind::Free => "single free",
                Kind::Ball => "single ball",
                Kind::Hinge => "single hinge",
            },
        }),
    }
}

/// Turns x and y to a hinge and to a bone across it.
fn frame(hinge: Vec3, bone: Vec3) -> Quat {
    let bone = bone.normalize();
    Quat::from_mat3(&Mat3::from_cols(hinge, bone, hinge.cross(bone)))
}

/// Height of a shape's lowest point, m.
fn lowest(shape: Shape, place: Vec3, turn: Quat) -> f32 {
    let up = turn.inverse() * Vec3::Z;
    let below = match shape {
        Shape::Plane => 0.0,
        Shape::Sphere { radius } => radius,
        Shape::Capsule { radius, half } => radius + half * up.z.abs(),
        Shape::Box { half } => half.dot(up.abs()),
    };
    place.z - below
}
