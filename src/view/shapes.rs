//! A simulated model as it is: its spheres, capsules and boxes.

use super::capsule_rig::{LEFT, RIGHT, TRUNK};
use super::scene::{Colour, Cuboid, Scene};
use crate::env::humanoid::task::{agent_bodies, agents};
use crate::physics::kinematics::kinematics;
use crate::physics::model::{Geom, GeomShape, Model};
use crate::physics::pose::Pose;
use crate::physics::spatial::Spatial;
use glam::{Quat, Vec3};

/// Trunk, left limbs and right limbs of a bout's fighters: red, then blue.
const CORNERS: [(&str, [Colour; 3]); 2] = [
    (
        "red/",
        [[0.62, 0.06, 0.05], [0.86, 0.30, 0.22], [0.42, 0.03, 0.04]],
    ),
    (
        "blue/",
        [[0.05, 0.13, 0.62], [0.20, 0.42, 0.90], [0.03, 0.06, 0.36]],
    ),
];
const THING: Colour = [0.42, 0.34, 0.30];
/// A ghost's colours are mixed with this one, by this fraction.
const GHOST: (Colour, f32) = ([0.80, 0.84, 0.88], 0.75);

/// Turns the bodies' axes, z up, x forward, to the scene's: y up, z forward.
const UPRIGHT: Quat = Quat::from_xyzw(-0.5, -0.5, -0.5, 0.5);

/// A point or a direction of the bodies' world in the scene's.
pub fn seen(at: Vec3) -> Vec3 {
    UPRIGHT * at
}

/// A point or a direction of the scene in the bodies' world: the opposite of [`seen`].
pub fn simulated(at: Vec3) -> Vec3 {
    UPRIGHT.inverse() * at
}

/// Poses of the bodies at positions `q`.
pub fn poses(model: &Model, q: &[f32]) -> Vec<Pose> {
    let mut poses = vec![Pose::default(); model.bodies.len()];
    let mut axes = vec![Spatial::ZERO; model.nv()];
    kinematics(model, q, &mut poses, &mut axes);
    poses
}

/// The point between the characters of a world, in the scene, and how far they are from it at most, m.
pub fn company(model: &Model, poses: &[Pose]) -> (Vec3, f32) {
    let roots = poses.iter().step_by(agent_bodies(model));
    let roots: Vec<Vec3> = roots
        .take(agents(model).max(1))
        .map(|pose| seen(pose.position))
        .collect();
    let middle = roots.iter().sum::<Vec3>() / roots.len() as f32;
    let apart = roots.iter().map(|root| root.distance(middle));
    (middle, apart.fold(0.0, f32::max))
}

/// Whether a body is there, or shown for comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// In its own colours.
    Solid,
    /// In pale ones.
    Ghost,
}

/// Adds a model, moved by `aside` (m), to a scene. The ground is the renderer's.
pub fn draw(scene: &mut Scene, model: &Model, poses: &[Pose], aside: Vec3, look: Look) {
    for geom in &model.geoms {
        let pose = geom.pose(poses);
        let pose = Pose {
            position: seen(pose.position) + aside,
            rotation: UPRIGHT * pose.rotation,
        };
        shape(scene, geom.shape, &pose, colour(model, geom, look));
    }
}

/// The colour of a shape: left limbs are blue, right ones orange, and what has no limbs is brown. Fighters have those
/// of their corners, paler at the left.
pub(super) fn colour(model: &Model, geom: &Geom, look: Look) -> Colour {
    let body = geom.body.map(|body| &model.bodies[body]);
    let name = body.map_or("", |body| &body.name);
    let alone = body.is_some_and(|body| model.trees[body.tree].bodies.len() == 1);
    let corner = CORNERS.iter().find(|(corner, _)| name.starts_with(corner));
    let [trunk, left, right] = corner.map_or([TRUNK, LEFT, RIGHT], |(_, colours)| *colours);
    let own = match name {
        _ if name.contains("left") => left,
        _ if name.contains("right") => right,
        _ if alone => THING,
        _ => trunk,
    };
    let (pale, fraction) = GHOST;
    match look {
        Look::Solid => own,
        Look::Ghost => std::array::from_fn(|i| own[i] + fraction * (pale[i] - own[i])),
    }
}

fn shape(scene: &mut Scene, shape: GeomShape, pose: &Pose, colour: Colour) {
    match shape {
        GeomShape::Plane => {}
        GeomShape::Sphere { radius } => scene.ball(pose.position, radius, colour),
        GeomShape::Capsule { radius, half } => {
            let ends = [-half, half].map(|along| pose.at(Vec3::Z * along));
            scene.rod(&ends, radius, colour);
        }
        GeomShape::Box { half } => scene.cuboids.push(Cuboid {
            centre: pose.position.to_array(),
            half: half.to_array(),
            rotation: pose.rotation.to_array(),
            colour,
        }),
    }
}
