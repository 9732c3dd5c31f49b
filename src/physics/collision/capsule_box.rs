//! Spheres and capsules against a box. A capsule touches as one or two spheres: one at the point of
//! its axis that is nearest to the box, and one at the end of the stretch of axis that runs on
//! along the box from there, as MuJoCo has it.

use super::contact_point::{Capsule, ContactManifold, ContactPoint, Cuboid, sign};
use glam::{BVec3, Vec3};

/// What is not nearer by this, m, is as near: rounding does not decide.
const NEARER: f32 = 3e-8;
/// Square of the area below which edge and axis are parallel, m^4; the box's other edges suffice.
const PARALLEL: f32 = 1e-15;

/// A capsule's axis in the frame of the box; `arm` leads from its middle to an end.
struct Axis {
    middle: Vec3,
    arm: Vec3,
}

impl Axis {
    fn at(&self, along: f32) -> Vec3 {
        self.middle + self.arm * along
    }
}

/// A point of the axis, and the point of the box nearest to it.
struct Near {
    /// From -1 to 1.
    along: f32,
    gap: f32,
    point: Vec3,
    /// A bit for each direction in which the point lies at the border: one at a face, two at an edge,
    /// three at a corner, none inside.
    border: u32,
}

pub fn capsule_box(round: &Capsule, cuboid: &Cuboid, out: &mut ContactManifold) {
    let inverse = cuboid.rotation.transpose();
    let axis = Axis {
        middle: inverse * (round.centre - cuboid.centre),
        arm: inverse * round.axis * round.half,
    };
    if round.half == 0.0 {
        return sphere_box(0, axis.middle, round.radius, cuboid, out);
    }
    let Some(near) = nearest(&axis, cuboid.half) else {
        return;
    };
    sphere_box(0, axis.at(near.along), round.radius, cuboid, out);
    if let Some(along) = second(&axis, &near, cuboid.half) {
        sphere_box(1, axis.at(along), round.radius, cuboid, out);
    }
}

/// `centre` is in the frame of the box.
fn sphere_box(
    number: usize,
    centre: Vec3,
    radius: f32,
    cuboid: &Cuboid,
    out: &mut ContactManifold,
) {
    let away = centre.clamp(-cuboid.half, cuboid.half) - centre;
    let outside = away.length();
    let (normal, gap) = match outside > 0.0 {
        true => (away / outside, outside),
        false => shallowest(centre, cuboid.half),
    };
    let distance = gap - radius;
    if distance < 0.0 {
        let position = cuboid.rotation * (centre + normal * (0.5 * (radius + gap))) + cuboid.centre;
        out.add(
            number,
            ContactPoint::new(position, cuboid.rotation * normal, distance),
        );
    }
}

/// The direction from the nearest face into the box, and minus the depth, of a point inside.
fn shallowest(point: Vec3, half: Vec3) -> (Vec3, f32) {
    let depths = half - point.abs();
    let axis = depths.min_position();
    let inwards = match point[axis] > 0.0 {
        true => -1.0,
        false => 1.0,
    };
    (Vec3::AXES[axis] * inwards, -depths[axis])
}

/// The ends of the axis that are above a face or inside, then the edges: the first that is nearest.
fn nearest(axis: &Axis, half: Vec3) -> Option<Near> {
    let ends = [-1.0, 1.0]
        .into_iter()
        .filter_map(|end| above(axis, end, half));
    let edges = (0..3).flat_map(|direction| {
        let corners = (0..8).filter(move |corner| corner >> direction & 1 == 0);
        corners.filter_map(move |corner| edge(axis, half, direction, corner))
    });
    ends.chain(edges)
        .reduce(|best, near| match near.gap + NEARER < best.gap {
            true => near,
            false => best,
        })
}

/// An end of the axis, if it is above a face or inside.
fn above(axis: &Axis, along: f32, half: Vec3) -> Option<Near> {
    let end = axis.at(along);
    let point = end.clamp(-half, half);
    let border = point.cmpne(end).bitmask();
    (border.count_ones() <= 1).then(|| Near {
        along,
        gap: end.distance(point),
        point,
        border,
    })
}

/// Points nearest to each other of the axis and of the edge that leads from a corner.
fn edge(axis: &Axis, half: Vec3, direction: usize, corner: u32) -> Option<Near> {
    let (unit, size) = (Vec3::AXES[direction], half[direction]);
    let flat = axis.arm * (Vec3::ONE - unit);
    if size * size * flat.length_squared() < PARALLEL {
        return None;
    }
    let positive = BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0);
    let middle = Vec3::select(positive, half, -half) * (Vec3::ONE - unit);
    let crossing = |along: f32| axis.at(along)[direction] / size;
    // Of the lines, then of the edge, then of both.
    let mut along = flat.dot(middle - axis.middle) / flat.length_squared();
    let mut position = crossing(along);
    let mut end = None;
    if position.abs() > 1.0 {
        position = sign(position);
        end = Some(position);
        let corner = middle + unit * (size * position);
        along = axis.arm.dot(corner - axis.middle) / axis.arm.length_squared();
    }
    if along.abs() > 1.0 {
        along = sign(along);
        position = crossing(along);
        if position.abs() > 1.0 {
            position = sign(position);
            end = Some(position);
        }
    }
    // Once at a corner it counts as there, even if the axis ends before.
    Some(Near {
        along,
        gap: axis.at(along).distance(middle + unit * (size * position)),
        point: middle + unit * (size * end.unwrap_or(position)),
        border: match end {
            Some(_) => 7,
            None => 7 ^ 1 << direction,
        },
    })
}

/// Where the axis, running on from the nearest point, ends or leaves the box's outline. None if it
/// leads away from the box both ways.
fn second(axis: &Axis, near: &Near, half: Vec3) -> Option<f32> {
    let inwards = (positive(axis.arm) ^ positive(near.point)) & near.border;
    // Whether forwards along the axis, and along which directions of the box it runs.
    let (forwards, runs) = match near.border.count_ones() {
        1 => (near.along < 0.0, 7 ^ near.border),
        2 if inwards.count_ones() == 1 => {
            let steeper = steeper(axis.arm, 7 ^ near.border);
            (inwards & steeper != 0, 7 ^ near.border | steeper)
        }
        3 if inwards != 0 && inwards != 7 => {
            let lone = match inwards.count_ones() {
                1 => inwards,
                _ => 7 ^ inwards,
            };
            let part = axis.arm[lone.trailing_zeros() as usize];
            match part * part > 0.5 * axis.arm.length_squared() {
                true => (inwards & lone != 0, lone),
                false => (inwards & lone == 0, 7 ^ lone),
            }
        }
        _ => return None,
    };
    let way = if forwards { 1.0 } else { -1.0 };
    let step = axis.arm * way;
    let leave = (0..3).filter(|i| runs >> i & 1 != 0).map(|i| {
        let border = half[i].copysign(step[i]);
        (border - near.point[i]) / step[i]
    });
    let end = 1.0 - way * near.along;
    let length = leave.filter(|leave| *leave > 0.0).fold(end, f32::min);
    Some(near.along + way * length)
}

/// A bit for each positive part.
fn positive(vector: Vec3) -> u32 {
    vector.cmpgt(Vec3::ZERO).bitmask()
}

/// That of the two directions across an edge which has the larger part of the axis.
fn steeper(arm: Vec3, edge: u32) -> u32 {
    let edge = edge.trailing_zeros();
    let [one, other] = [(edge + 1) % 3, (edge + 2) % 3];
    match arm[one as usize].abs() > arm[other as usize].abs() {
        true => 1 << one,
        false => 1 << other,
    }
}
