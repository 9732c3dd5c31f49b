//! A simulated model as it is: its spheres, capsules and boxes.

use super::capsule_rig::{LEFT, RIGHT, TRUNK};
use super::scene::{Colour, Scene};
use crate::physics::model::{Geom, GeomShape, Model};
use crate::physics::pose::Pose;
use glam::{Quat, Vec3};

/// A ghost's colours are mixed with this one, by this fraction.
const GHOST: (Colour, f32) = ([0.80, 0.84, 0.88], 0.75);
/// Radius of the edges of a rotated box, m.
const ROUNDING: f32 = 0.02;
/// Most rods beside each other: a box that is larger has gaps.
const RODS: f32 = 64.0;

/// Turns the bodies' axes, z up, x forward, to the scene's: y up, z forward.
const UPRIGHT: Quat = Quat::from_xyzw(-0.5, -0.5, -0.5, 0.5);

/// A point of the bodies' world in the scene's.
pub fn seen(at: Vec3) -> Vec3 {
    UPRIGHT * at
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

fn colour(model: &Model, geom: &Geom, look: Look) -> Colour {
    let body = geom.body.map_or("", |body| &model.bodies[body].name);
    let own = match body {
        _ if body.contains("left") => LEFT,
        _ if body.contains("right") => RIGHT,
        _ => TRUNK,
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
        GeomShape::Box { half } => cuboid(scene, half, pose, colour),
    }
}

/// Scenes have upright boxes only: rods along x, side by side, fill a rotated one.
fn cuboid(scene: &mut Scene, half: Vec3, pose: &Pose, colour: Colour) {
    let radius = half.min_element().min(ROUNDING);
    let inner = half - radius;
    for y in steps(inner.y, radius) {
        for z in steps(inner.z, radius) {
            let ends = [-inner.x, inner.x].map(|x| pose.at(Vec3::new(x, y, z)));
            scene.rod(&ends, radius, colour);
        }
    }
}

/// From -`end` to `end`, no further apart than `most`.
fn steps(end: f32, most: f32) -> impl Iterator<Item = f32> {
    let count = (2.0 * end / most).ceil().clamp(1.0, RODS);
    (0..=count as usize).map(move |step| end * (2.0 * step as f32 / count - 1.0))
}
