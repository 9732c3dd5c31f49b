//! Shapes in double precision.

use crate::physics::model::GeomShape;
use glam::DVec3;
use std::f64::consts::PI;

/// A [`GeomShape`] in double precision, or a shape that can weigh but not touch.
pub enum GeomShape64 {
    Plane,
    Sphere { radius: f64 },
    Capsule { radius: f64, half: f64 },
    Box { half: DVec3 },
    Cylinder { radius: f64, half: f64 },
    Ellipsoid { half: DVec3 },
}

impl GeomShape64 {
    /// The shape in single precision, if it is one that can touch.
    pub fn narrowed(&self) -> Option<GeomShape> {
        Some(match *self {
            GeomShape64::Plane => GeomShape::Plane,
            GeomShape64::Sphere { radius } => GeomShape::Sphere {
                radius: radius as f32,
            },
            GeomShape64::Capsule { radius, half } => GeomShape::Capsule {
                radius: radius as f32,
                half: half as f32,
            },
            GeomShape64::Box { half } => GeomShape::Box {
                half: half.as_vec3(),
            },
            GeomShape64::Cylinder { .. } | GeomShape64::Ellipsoid { .. } => return None,
        })
    }

    /// m^3; none of a plane.
    pub fn volume(&self) -> f64 {
        match *self {
            GeomShape64::Plane => 0.0,
            GeomShape64::Sphere { radius } => 4.0 / 3.0 * PI * radius.powi(3),
            GeomShape64::Capsule { radius, half } => {
                PI * radius * radius * (2.0 * half + 4.0 / 3.0 * radius)
            }
            GeomShape64::Box { half } => 8.0 * half.element_product(),
            GeomShape64::Cylinder { radius, half } => PI * radius * radius * 2.0 * half,
            GeomShape64::Ellipsoid { half } => 4.0 / 3.0 * PI * half.element_product(),
        }
    }
}
