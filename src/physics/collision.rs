//! Contacts between the shapes of a world, as MuJoCo detects them: points midway between two surfaces.

mod box_box;
mod capsule;
mod capsule_box;
mod plane;

use super::model::{Geom, GeomShape, Model};
use super::pose::Pose;
use glam::{Mat3, Vec3};

/// A point where one shape reaches into another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactPoint {
    /// Midway between the two surfaces.
    pub position: Vec3,
    /// From the first shape to the second.
    pub normal: Vec3,
    /// Across the normal; the second tangent is normal x tangent.
    pub tangent: Vec3,
    /// Negative: how deep they reach into each other.
    pub distance: f32,
}

impl ContactPoint {
    fn new(position: Vec3, normal: Vec3, distance: f32) -> ContactPoint {
        let tangent = match normal.y.abs() < 0.5 {
            true => across(normal, Vec3::Y),
            false => across(normal, Vec3::Z),
        };
        ContactPoint {
            position,
            normal,
            tangent,
            distance,
        }
    }
}

/// The part of a vector across a normal, as a unit vector.
fn across(normal: Vec3, vector: Vec3) -> Vec3 {
    let part = vector - normal * normal.dot(vector);
    part.try_normalize().unwrap_or(Vec3::X)
}

fn sign(value: f32) -> f32 {
    if value < 0.0 { -1.0 } else { 1.0 }
}

/// Contact points of a pair at most.
pub const MAX_POINTS: usize = 8;

/// The contact points of a pair.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactManifold {
    points: [ContactPoint; MAX_POINTS],
    numbers: [u32; MAX_POINTS],
    len: usize,
}

impl ContactManifold {
    /// Adds a point, unless the shapes are apart there. Its number, less than [`MAX_POINTS`], tells it
    /// from the others of the pair, from step to step.
    fn add(&mut self, number: usize, point: ContactPoint) {
        if point.distance < 0.0 && self.len < MAX_POINTS {
            self.points[self.len] = point;
            self.numbers[self.len] = number as u32;
            self.len += 1;
        }
    }

    /// Removes all points.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// The points.
    pub fn as_slice(&self) -> &[ContactPoint] {
        &self.points[..self.len]
    }

    /// The numbers of the points.
    pub fn numbers(&self) -> &[u32] {
        &self.numbers[..self.len]
    }
}

/// A geom in the world.
#[derive(Clone, Copy, Debug)]
pub struct WorldGeom {
    pub shape: GeomShape,
    pub position: Vec3,
    pub rotation: Mat3,
}

/// A capsule in the world, or a sphere: a capsule of zero length.
struct Capsule {
    centre: Vec3,
    axis: Vec3,
    half: f32,
    radius: f32,
}

impl Capsule {
    fn at(&self, along: f32) -> Vec3 {
        self.centre + self.axis * along
    }

    fn clamp(&self, along: f32) -> f32 {
        along.clamp(-self.half, self.half)
    }
}

/// A box in the world.
struct Cuboid {
    centre: Vec3,
    rotation: Mat3,
    half: Vec3,
}

impl WorldGeom {
    fn new(geom: &Geom, poses: &[Pose]) -> WorldGeom {
        let pose = geom.pose(poses);
        WorldGeom {
            shape: geom.shape,
            position: pose.position,
            rotation: Mat3::from_quat(pose.rotation),
        }
    }

    fn capsule(&self) -> Capsule {
        let (radius, half) = match self.shape {
            GeomShape::Sphere { radius } => (radius, 0.0),
            GeomShape::Capsule { radius, half } => (radius, half),
            _ => unreachable!("a capsule or a sphere"),
        };
        Capsule {
            centre: self.position,
            axis: self.rotation.z_axis,
            half,
            radius,
        }
    }

    fn cuboid(&self, half: Vec3) -> Cuboid {
        Cuboid {
            centre: self.position,
            rotation: self.rotation,
            half,
        }
    }

    /// Whether bounding spheres, of radii with this `sum`, or a plane and a sphere, are apart.
    fn bounding_spheres_apart(&self, other: &WorldGeom, sum: f32) -> bool {
        let between = other.position - self.position;
        match self.shape {
            GeomShape::Plane => self.rotation.z_axis.dot(between) > sum,
            _ => between.length_squared() > sum * sum,
        }
    }
}

/// Which shapes a pair is of, in the order in which a model has its pairs. Spheres are capsules of zero
/// length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PairKind {
    PlaneCapsule,
    PlaneBox,
    CapsuleCapsule,
    CapsuleBox,
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
    pub points: Vec<ContactPoint>,
    /// Ids of the points: the pair times [`MAX_POINTS`] plus the number in the pair, the same from step
    /// to step.
    pub ids: Vec<u32>,
    /// Points that found no room.
    pub overflow: u32,
    geoms: Vec<(WorldGeom, f32)>,
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

/// Detects the contacts of a world whose bodies have these poses, the first `max_contacts` of them in the
/// order of the model's pairs.
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
        let free = max_contacts - out.points.len();
        let kept = manifold.len.min(free);
        out.points.extend_from_slice(&manifold.as_slice()[..kept]);
        let numbers = &manifold.numbers()[..kept];
        out.ids.extend(
            numbers
                .iter()
                .map(|number| (pair * MAX_POINTS) as u32 + number),
        );
        out.overflow += (manifold.len - kept) as u32;
    }
}
