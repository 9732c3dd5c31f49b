//! Whatever reaches below a plane.

use super::{Capsule, Cuboid, Placed, Touch, Touches, across};
use glam::{BVec3, Vec3};

/// A box touches with its lowest corners, at most so many.
const CORNERS: usize = 4;

/// A touch for each end; the first tangent follows the capsule.
pub fn capsule(plane: &Placed, capsule: &Capsule, out: &mut Touches) {
    let normal = plane.turn.z_axis;
    let ends: &[f32] = match capsule.half > 0.0 {
        true => &[1.0, -1.0],
        false => &[0.0],
    };
    for (number, end) in ends.iter().enumerate() {
        let centre = capsule.at(end * capsule.half);
        let distance = normal.dot(centre - plane.place) - capsule.radius;
        if distance >= 0.0 {
            continue;
        }
        let place = centre - normal * (capsule.radius + 0.5 * distance);
        let mut touch = Touch::new(place, normal, distance);
        if capsule.half > 0.0 {
            touch.tangent = across(normal, capsule.axis);
        }
        out.add(number, touch);
    }
}

pub fn cuboid(plane: &Placed, cuboid: &Cuboid, out: &mut Touches) {
    let normal = plane.turn.z_axis;
    let height = normal.dot(cuboid.centre - plane.place);
    let mut found = 0;
    for number in 0..8 {
        let positive = BVec3::new(number & 1 != 0, number & 2 != 0, number & 4 != 0);
        let corner = cuboid.turn * Vec3::select(positive, cuboid.half, -cuboid.half);
        // Of a box whose centre is below, the upper corners do not count.
        let rise = normal.dot(corner);
        let distance = height + rise;
        if distance >= 0.0 || rise > 0.0 || found == CORNERS {
            continue;
        }
        found += 1;
        let place = cuboid.centre + corner - normal * (0.5 * distance);
        out.add(number, Touch::new(place, normal, distance));
    }
}
