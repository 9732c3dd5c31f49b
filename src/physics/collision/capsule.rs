//! Spheres and capsules with each other: where the points of their axes nearest to each other are.

use super::contact_point::{Capsule, ContactManifold, ContactPoint, sign};
use glam::Vec3;

/// Squared sine of the angle below which two capsules lie side by side.
const PARALLEL: f32 = 1e-8;
/// Axes that pass this close, m per unit of the angle's sine, all but meet.
const MEETING: f32 = 0.1;

pub fn capsule_capsule(first: &Capsule, second: &Capsule, out: &mut ContactManifold) {
    let across = first.axis.cross(second.axis);
    let sine2 = across.length_squared();
    let crossed = sine2 >= PARALLEL;
    if !crossed && first.half > 0.0 && second.half > 0.0 {
        return side_by_side(first, second, out);
    }
    // By cross products: determinants of dot products lose their digits where axes are all but parallel.
    let between = second.centre - first.centre;
    let meeting = match crossed {
        true => between.cross(second.axis).dot(across) / sine2,
        false => 0.0,
    };
    let start = first.clamp(meeting);
    let other = second.clamp((first.axis * start - between).dot(second.axis));
    let one = first.clamp((second.axis * other + between).dot(first.axis));
    let apart = between + second.axis * other - first.axis * one;
    let gap2 = apart.length_squared();
    if gap2 >= (first.radius + second.radius).powi(2) {
        return;
    }
    // Where axes all but meet, the way from one to the other has no digits left, but is across both.
    let inner = one.abs() < first.half && other.abs() < second.half;
    let direction = match inner && gap2 < MEETING * MEETING * sine2 {
        true => across * sign(between.dot(across)),
        false => apart,
    };
    out.add(
        0,
        point(first.at(one), direction, gap2.sqrt(), [first, second]),
    );
}

/// A point at either end of the stretch that two parallel capsules have in common: each end is one of
/// the second's, or the first's where that is shorter.
fn side_by_side(first: &Capsule, second: &Capsule, out: &mut ContactManifold) {
    let between = second.centre - first.centre;
    let end = sign(first.axis.dot(second.axis)) * second.half;
    for (number, end) in [-end, end].into_iter().enumerate() {
        let opposite = (second.axis * end + between).dot(first.axis);
        let one = first.clamp(opposite);
        let other = match one == opposite {
            true => end,
            false => second.clamp((first.axis * one - between).dot(second.axis)),
        };
        let apart = between + second.axis * other - first.axis * one;
        out.add(
            number,
            point(first.at(one), apart, apart.length(), [first, second]),
        );
    }
}

/// The contact point of spheres `gap` apart, that of the first being at `centre`.
fn point(centre: Vec3, direction: Vec3, gap: f32, [first, second]: [&Capsule; 2]) -> ContactPoint {
    let normal = direction.try_normalize().unwrap_or(Vec3::X);
    let distance = gap - first.radius - second.radius;
    let position = centre + normal * (first.radius + 0.5 * distance);
    ContactPoint::new(position, normal, distance)
}
