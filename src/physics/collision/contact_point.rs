//! Contact points, and the shapes in the world that they are between.

use crate::physics::model::{Geom, GeomShape};
use crate::physics::pose::Pose;
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
    /// A point at `position`, in the world's frame, with the tangent of MuJoCo's `mju_makeFrame`: the part
    /// across the unit `normal` of the world's y axis or, where the normal is within 60 degrees of y, of z.
    /// `distance` is in m, negative where the shapes overlap.
    pub fn new(position: Vec3, normal: Vec3, distance: f32) -> ContactPoint {
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
pub fn across(normal: Vec3, vector: Vec3) -> Vec3 {
    let part = vector - normal * normal.dot(vector);
    part.try_normalize().unwrap_or(Vec3::X)
}

pub fn sign(value: f32) -> f32 {
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
    pub fn add(&mut self, number: usize, point: ContactPoint) {
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
    /// Shape and sizes in the geom's own frame.
    pub shape: GeomShape,
    /// Origin of the geom's frame in the world, m (MuJoCo's `geom_xpos`).
    pub position: Vec3,
    /// Rotation from the geom's frame to the world's (MuJoCo's `geom_xmat`).
    pub rotation: Mat3,
}

/// A capsule in the world, or a sphere: a capsule of zero length.
pub struct Capsule {
    pub centre: Vec3,
    pub axis: Vec3,
    pub half: f32,
    pub radius: f32,
}

impl Capsule {
    pub fn at(&self, along: f32) -> Vec3 {
        self.centre + self.axis * along
    }

    pub fn clamp(&self, along: f32) -> f32 {
        along.clamp(-self.half, self.half)
    }
}

/// A box in the world.
pub struct Cuboid {
    pub centre: Vec3,
    pub rotation: Mat3,
    pub half: Vec3,
}

impl WorldGeom {
    /// Places a geom in the world; `poses`, `[bodies]`, are those of the bodies.
    pub fn new(geom: &Geom, poses: &[Pose]) -> WorldGeom {
        let pose = geom.pose(poses);
        WorldGeom {
            shape: geom.shape,
            position: pose.position,
            rotation: Mat3::from_quat(pose.rotation),
        }
    }

    /// The geom as a capsule along its own z axis, a sphere as one of zero length.
    ///
    /// # Panics
    /// If the geom is a plane or a box.
    pub fn capsule(&self) -> Capsule {
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

    /// The geom as a box; `half` are half the lengths of its edges, m.
    pub fn cuboid(&self, half: Vec3) -> Cuboid {
        Cuboid {
            centre: self.position,
            rotation: self.rotation,
            half,
        }
    }

    /// Whether bounding spheres, of radii with this `sum`, or a plane and a sphere, are apart.
    pub fn bounding_spheres_apart(&self, other: &WorldGeom, sum: f32) -> bool {
        let between = other.position - self.position;
        match self.shape {
            GeomShape::Plane => self.rotation.z_axis.dot(between) > sum,
            _ => between.length_squared() > sum * sum,
        }
    }
}
