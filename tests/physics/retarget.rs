//! Recordings put into the humanoid, and the library of them.

mod library;
mod real;
mod strips;
mod synthetic;

use footwork::motion::clip::Clip;
use footwork::motion::roles::Roles;
use footwork::physics::humanoid::humanoid;
use footwork::physics::kinematics::kinematics;
use footwork::physics::model::{GeomShape, JointKind, Model};
use footwork::physics::motion_clip::MotionClip;
use footwork::physics::pose::Pose;
use footwork::physics::spatial::Spatial;
use glam::{Quat, Vec3};

/// Of the recordings' axes, y up and z forward, the bodies': z up and x forward.
const UPRIGHT: Quat = Quat::from_xyzw(0.5, 0.5, 0.5, 0.5);

/// From the humanoid's hip to its ankle, m.
const LEG: f32 = 0.831416;

/// A walk that nobody recorded.
pub(crate) fn performed() -> (Clip, Roles) {
    let (mut clips, roles) = footwork::motion::synthetic::perform(3, 1.0);
    (clips.swap_remove(0), roles)
}

/// The poses of a humanoid's bodies.
pub(crate) struct Bodies<'a> {
    model: &'a Model,
    poses: Vec<Pose>,
}

impl Bodies<'_> {
    pub(crate) fn of<'a>(model: &'a Model, q: &[f32]) -> Bodies<'a> {
        let mut poses = vec![Pose::default(); model.bodies.len()];
        let mut axes = vec![Spatial::ZERO; model.nv()];
        kinematics(model, q, &mut poses, &mut axes);
        Bodies { model, poses }
    }

    pub(crate) fn pose(&self, name: &str) -> Pose {
        self.poses[self.model.body(name).expect("a humanoid's body")]
    }

    pub(crate) fn position(&self, name: &str) -> Vec3 {
        self.pose(name).position
    }

    /// Height of the lowest corner of the feet, m.
    pub(crate) fn lowest(&self) -> f32 {
        let feet = self
            .model
            .geoms
            .iter()
            .filter(|geom| geom.name.ends_with("foot"));
        let corners = feet.flat_map(|geom| {
            let GeomShape::Box { half } = geom.shape else {
                panic!("feet are boxes");
            };
            let pose = self.pose(&geom.name);
            let sign = |corner: u32, axis: u32| 1.0 - 2.0 * ((corner >> axis) & 1) as f32;
            (0..8).map(move |c| {
                let corner = half * Vec3::new(sign(c, 0), sign(c, 1), sign(c, 2));
                pose.at(geom.position + corner).z
            })
        });
        corners.fold(f32::INFINITY, f32::min)
    }
}

/// Fastest turn of any joint but the root, rad/s.
fn max_speed(model: &Model, motion: &MotionClip) -> f32 {
    let speeds = (0..motion.frames).flat_map(|frame| {
        let joints = model
            .joints
            .iter()
            .filter(|joint| joint.kind != JointKind::Free);
        joints.map(move |joint| {
            let v = &motion.v(frame)[joint.v..][..joint.kind.nv()];
            v.iter().map(|v| v * v).sum::<f32>().sqrt()
        })
    });
    speeds.fold(0.0, f32::max)
}

/// The value that so large a share of all are no larger than.
fn percentile(values: &mut [f32], share: f32) -> f32 {
    let position = ((values.len() - 1) as f32 * share) as usize;
    *values.select_nth_unstable_by(position, f32::total_cmp).1
}

fn humanoid_and(clip: &Clip, roles: &Roles) -> (Model, MotionClip) {
    let model = humanoid();
    let motion = footwork::physics::retarget::retarget(clip, roles, &model);
    (model, motion.expect("a person's skeleton"))
}
