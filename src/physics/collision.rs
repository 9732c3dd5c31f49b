//! Contacts between the shapes of a world, as MuJoCo detects them: points midway between two surfaces.

mod box_box;
mod capsule;
mod capsule_box;
mod contact_point;
mod plane;

use super::model::{GeomShape, Model};
use super::pose::Pose;
pub use contact_point::{ContactManifold, ContactPoint, MAX_POINTS, WorldGeom};

/// Which shapes a pair is of, in the order in which a model has its pairs. Spheres are capsules of zero
/// length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PairKind {
    /// A plane and a capsule or sphere.
    PlaneCapsule,
    /// A plane and a box.
    PlaneBox,
    /// Two capsules or spheres.
    CapsuleCapsule,
    /// A capsule or sphere and a box.
    CapsuleBox,
    /// Two boxes.
    BoxBox,
}

impl PairKind {
    /// The kind of two shapes, the first of which comes first in [`GeomShape`]. Two planes, which never
    /// meet, count as if the second were a capsule.
    pub fn of(shapes: [GeomShape; 2]) -> PairKind {
        match shapes {
            [GeomShape::Plane, GeomShape::Box { .. }] => PairKind::PlaneBox,
            [GeomShape::Plane, _] => PairKind::PlaneCapsule,
            [GeomShape::Box { .. }, _] => PairKind::BoxBox,
            [_, GeomShape::Box { .. }] => PairKind::CapsuleBox,
            _ => PairKind::CapsuleCapsule,
        }
    }
}

/// Adds the contact points of two shapes, the first of which comes first in [`GeomShape`].
pub fn collide(first: &WorldGeom, second: &WorldGeom, out: &mut ContactManifold) {
    match (first.shape, second.shape) {
        (_, GeomShape::Plane) => {}
        (GeomShape::Plane, GeomShape::Box { half }) => {
            plane::cuboid(first, &second.cuboid(half), out)
        }
        (GeomShape::Plane, _) => plane::capsule(first, &second.capsule(), out),
        (GeomShape::Box { half: one }, GeomShape::Box { half: other }) => {
            box_box::box_box(&first.cuboid(one), &second.cuboid(other), out);
        }
        (_, GeomShape::Box { half }) => {
            capsule_box::capsule_box(&first.capsule(), &second.cuboid(half), out);
        }
        _ => capsule::capsule_capsule(&first.capsule(), &second.capsule(), out),
    }
}

/// The contacts of a world.
#[derive(Clone, Debug, Default)]
pub struct DetectedContacts {
    /// Contact points in the order of the model's pairs, but that deeper ones have taken the places of
    /// shallow ones where there was no room.
    pub points: Vec<ContactPoint>,
    /// Ids of the points: the pair times [`MAX_POINTS`] plus the number in the pair, the same from step
    /// to step.
    pub ids: Vec<u32>,
    /// Points that found no room: the shallowest.
    pub overflow: u32,
    geoms: Vec<(WorldGeom, f32)>,
}

impl DetectedContacts {
    /// Adds a point; without room, in the place of the shallowest, if that is shallower than it.
    fn add(&mut self, point: ContactPoint, id: u32, max_contacts: usize) {
        if self.points.len() < max_contacts {
            self.points.push(point);
            self.ids.push(id);
            return;
        }
        self.overflow += 1;
        let (mut shallowest, mut distance) = (None, point.distance);
        for (slot, kept) in self.points.iter().enumerate() {
            if kept.distance > distance {
                (shallowest, distance) = (Some(slot), kept.distance);
            }
        }
        if let Some(slot) = shallowest {
            (self.points[slot], self.ids[slot]) = (point, id);
        }
    }
}

/// Radius of a sphere that holds a shape; zero of a plane.
pub fn bounding_radius(shape: GeomShape) -> f32 {
    match shape {
        GeomShape::Plane => 0.0,
        GeomShape::Sphere { radius } => radius,
        GeomShape::Capsule { radius, half } => radius + half,
        GeomShape::Box { half } => half.length(),
    }
}

/// Detects the contacts of a world whose bodies have these poses: all, or the deepest if there are more than
/// `max_contacts`.
pub fn detect_contacts(
    model: &Model,
    poses: &[Pose],
    max_contacts: usize,
    out: &mut DetectedContacts,
) {
    out.points.clear();
    out.ids.clear();
    out.overflow = 0;
    out.geoms.clear();
    let geoms = model.geoms.iter();
    out.geoms
        .extend(geoms.map(|geom| (WorldGeom::new(geom, poses), bounding_radius(geom.shape))));
    let mut manifold = ContactManifold::default();
    for (pair, &[first, second]) in model.pairs.iter().enumerate() {
        let ((first, one), (second, other)) = (&out.geoms[first], &out.geoms[second]);
        if first.bounding_spheres_apart(second, one + other) {
            continue;
        }
        manifold.clear();
        collide(first, second, &mut manifold);
        for (point, number) in manifold.as_slice().iter().zip(manifold.numbers()) {
            out.add(*point, (pair * MAX_POINTS) as u32 + number, max_contacts);
        }
    }
}
