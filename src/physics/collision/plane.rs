//! Whatever reaches below a plane.

use super::contact_point::{Capsule, ContactManifold, ContactPoint, Cuboid, WorldGeom, across};
use glam::{BVec3, Vec3};

/// A box touches with its lowest corners, at most so many.
const CORNERS: usize = 4;

/// A point for each end; the first tangent follows the capsule.
pub fn capsule(plane: &WorldGeom, capsule: &Capsule, out: &mut ContactManifold) {
    let normal = plane.rotation.z_axis;
    let ends: &[f32] = match capsule.half > 0.0 {
        true => &[1.0, -1.0],
        false => &[0.0],
    };
    for (number, end) in ends.iter().enumerate() {
        let centre = capsule.at(end * capsule.half);
        let distance = normal.dot(centre - plane.position) - capsule.radius;
        if distance >= 0.0 {
            continue;
        }
        let position = centre - normal * (capsule.radius + 0.5 * distance);
        let mut point = ContactPoint::new(position, normal, distance);
        if capsule.half > 0.0 {
            point.tangent = across(normal, capsule.axis);
        }
        out.add(number, point);
    }
}

pub fn cuboid(plane: &WorldGeom, cuboid: &Cuboid, out: &mut ContactManifold) {
    let normal = plane.rotation.z_axis;
    let height = normal.dot(cuboid.centre - plane.position);
    let mut found = 0;
    for number in 0..8 {
        let positive = BVec3::new(number & 1 != 0, number & 2 != 0, number & 4 != 0);
        let corner = cuboid.rotation * Vec3::select(positive, cuboid.half, -cuboid.half);
        // Of a box whose centre is below, the upper corners do not count.
        let rise = normal.dot(corner);
        let distance = height + rise;
        if distance >= 0.0 || rise > 0.0 || found == CORNERS {
            continue;
        }
        found += 1;
        let position = cuboid.centre + corner - normal * (0.5 * distance);
        out.add(number, ContactPoint::new(position, normal, distance));
    }
}
