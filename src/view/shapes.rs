//! A simulated model as it is: its spheres, capsules and boxes.

use super::scene::{Cuboid, Scene};
use crate::env::humanoid::task::{agent_bodies, agents};
pub use crate::physics::kinematics::poses;
use crate::physics::model::{Geom, GeomShape, Model};
use crate::physics::pose::{Pose, Y_UP};
use crate::playback::colours::{Colour, body_colour};
use glam::Vec3;

/// A ghost's colours are mixed with this one, by this fraction.
const GHOST: (Colour, f32) = ([0.80, 0.84, 0.88], 0.75);

/// A point or a direction of the bodies' world in the scene's.
pub fn seen(at: Vec3) -> Vec3 {
    Y_UP * at
}

/// A point or a direction of the scene in the bodies' world: the opposite of [`seen`].
pub fn simulated(at: Vec3) -> Vec3 {
    Y_UP.inverse() * at
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
            rotation: Y_UP * pose.rotation,
        };
        shape(scene, geom.shape, &pose, colour(model, geom, look));
    }
}

/// The colour of a shape, which is its body's.
pub(super) fn colour(model: &Model, geom: &Geom, look: Look) -> Colour {
    let name = geom.body.map_or("", |body| &model.bodies[body].name);
    let alone = geom.body.is_some_and(|body| model.is_alone(body));
    let own = body_colour(name, alone);
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
