//! A box against a box: of fifteen axes the one along which they overlap least is the normal. Across
//! a face, the other box's face, clipped by the sides of the first, touches with its corners; across
//! two edges, these touch in a point.

use super::contact_point::{ContactManifold, ContactPoint, Cuboid, MAX_POINTS, sign};
use glam::{Mat3, Vec3};

/// Squared sine of the angle below which edges are parallel: the faces' axes suffice.
const PARALLEL: f32 = 1e-10;
/// An axis of edges this nearly along the best face's is taken for it, unless it is better by a part
/// of the depth: a face has more points.
const ALIKE: f32 = 0.99;
const BETTER: f32 = 0.05;
/// What rounding may change, of a separation as a part of it and of a length in m, does not decide.
const PART: f32 = 1e-6;
const SLIP: f32 = 1e-7;
/// Part of the normal below which the edges on both sides of a box are equally far out.
const LEVEL: f32 = 1e-5;

/// Half sizes of both, and the second as the first sees it.
struct Pair {
    first: Vec3,
    second: Vec3,
    between: Vec3,
    rotation: Mat3,
}

/// Axes are numbered: three of the first's faces, three of the second's, nine of their edges.
const FACES: usize = 6;
const AXES: usize = 15;

#[derive(Clone, Copy)]
struct Axis {
    number: usize,
    /// Unit, in the first's frame.
    along: Vec3,
    /// Negative: how far they overlap.
    distance: f32,
}

pub fn box_box(first: &Cuboid, second: &Cuboid, out: &mut ContactManifold) {
    let inverse = first.rotation.transpose();
    let pair = Pair {
        first: first.half,
        second: second.half,
        between: inverse * (second.centre - first.centre),
        rotation: inverse * second.rotation,
    };
    let Some(axis) = least_overlap(&pair) else {
        return;
    };
    match axis.number {
        face @ 0..3 => face_face(first, &pair, face, 1.0, out),
        face @ 3..FACES => face_face(second, &pair.swapped(), face - 3, -1.0, out),
        edges => edge_edge(first, &pair, edges - FACES, axis.along, out),
    }
}

impl Pair {
    fn axis(&self, number: usize) -> Vec3 {
        match number {
            0..3 => Vec3::AXES[number],
            3..FACES => self.rotation.col(number - 3),
            _ => Vec3::AXES[(number - FACES) / 3].cross(self.rotation.col(number % 3)),
        }
    }

    fn distance(&self, along: Vec3) -> f32 {
        let seen = self.rotation.transpose() * along;
        self.between.dot(along).abs() - self.first.dot(along.abs()) - self.second.dot(seen.abs())
    }

    fn swapped(&self) -> Pair {
        let rotation = self.rotation.transpose();
        Pair {
            first: self.second,
            second: self.first,
            between: -(rotation * self.between),
            rotation,
        }
    }
}

/// None if they are apart.
fn least_overlap(pair: &Pair) -> Option<Axis> {
    let none = Axis {
        number: 0,
        along: Vec3::ZERO,
        distance: f32::NEG_INFINITY,
    };
    let (mut best, mut face) = (none, none);
    for number in 0..AXES {
        let along = pair.axis(number);
        let length2 = along.length_squared();
        if length2 < PARALLEL {
            continue;
        }
        let along = along / length2.sqrt();
        let distance = pair.distance(along);
        if distance > 0.0 {
            return None;
        }
        let least = match number < FACES {
            true => distance,
            false => distance * (1.0 + PART),
        };
        if least > best.distance {
            best = Axis {
                number,
                along,
                distance,
            };
        }
        if number + 1 == FACES {
            face = best;
        }
    }
    let alike = best.along.dot(face.along).abs() > ALIKE;
    let better = best.distance > face.distance * (1.0 - BETTER) + SLIP;
    Some(if alike && !better { face } else { best })
}

/// `edges` numbers the pair of edge directions.
fn edge_edge(frame: &Cuboid, pair: &Pair, edges: usize, along: Vec3, out: &mut ContactManifold) {
    let normal = along * sign(along.dot(pair.between));
    let (one, other) = (Vec3::AXES[edges / 3], pair.rotation.col(edges % 3));
    let [half, other_half] = [pair.first[edges / 3], pair.second[edges % 3]];
    let seen = -(pair.rotation.transpose() * normal);
    let (cosine, sine2) = (one.dot(other), one.cross(other).length_squared());
    let (mut nearest, mut apart) = (f32::INFINITY, [Vec3::ZERO; 2]);
    // Middles of the outermost edges; where either of two may be, the pair nearest to each other.
    for choice in 0..4 {
        let a = outermost(pair.first, normal, edges / 3, choice & 1 != 0);
        let b = outermost(pair.second, seen, edges % 3, choice & 2 != 0);
        let b = pair.rotation * b + pair.between;
        let (along_one, along_other) = (one.dot(b - a), other.dot(b - a));
        let s = ((along_one - cosine * along_other) / sine2).clamp(-half, half);
        let t = (cosine * s - along_other).clamp(-other_half, other_half);
        let s = (along_one + cosine * t).clamp(-half, half);
        let (a, b) = (a + one * s, b + other * t);
        if a.distance_squared(b) < nearest {
            (nearest, apart) = (a.distance_squared(b), [a, b]);
        }
    }
    let [a, b] = apart;
    let position = frame.rotation * (0.5 * (a + b)) + frame.centre;
    out.add(
        0,
        ContactPoint::new(position, frame.rotation * normal, normal.dot(b - a)),
    );
}

/// Middle of the edge along `edge` that is farthest out; the other one if two may be and `other`.
fn outermost(half: Vec3, normal: Vec3, edge: usize, other: bool) -> Vec3 {
    let level = normal.abs().cmplt(Vec3::splat(LEVEL));
    let corner = Vec3::select(normal.cmpge(Vec3::ZERO), half, -half);
    let corner = match other {
        true => Vec3::select(level, -corner, corner),
        false => corner,
    };
    corner * (Vec3::ONE - Vec3::AXES[edge])
}

/// `frame` is the first of the pair, whose face counts; `way` is -1 if normals lead to it.
fn face_face(frame: &Cuboid, pair: &Pair, face: usize, way: f32, out: &mut ContactManifold) {
    let [x, y] = [(face + 1) % 3, (face + 2) % 3];
    let side = sign(pair.between[face]);
    let height = pair.first[face];
    // Along the face, and above it.
    let flat = |v: Vec3| Vec3::new(v[x], v[y], side * v[face]);
    let mut points = opposing(pair, face, side).map(|corner| flat(corner) - Vec3::Z * height);
    points.clip(Vec3::X, pair.first[x]);
    points.clip(Vec3::NEG_X, pair.first[x]);
    points.clip(Vec3::Y, pair.first[y]);
    points.clip(Vec3::NEG_Y, pair.first[y]);
    let normal = frame.rotation.col(face) * (side * way);
    for (number, point) in points.as_slice().iter().enumerate() {
        if points.as_slice()[..number]
            .iter()
            .any(|earlier| same(*earlier, *point))
        {
            continue;
        }
        let mut position = Vec3::ZERO;
        (position[x], position[y]) = (point.x, point.y);
        position[face] = side * (height + 0.5 * point.z);
        let position = frame.rotation * position + frame.centre;
        out.add(number, ContactPoint::new(position, normal, point.z));
    }
}

/// The corners, one after the other, of that face of the second box that looks at the first's most.
fn opposing(pair: &Pair, face: usize, side: f32) -> Polygon {
    let slopes = pair.rotation.row(face);
    let axis = slopes.abs().max_position();
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let edge = |axis: usize| pair.rotation.col(axis) * pair.second[axis];
    let centre = match side * slopes[axis] > 0.0 {
        true => pair.between - edge(axis),
        false => pair.between + edge(axis),
    };
    let (u, v) = (edge(u), edge(v));
    let mut polygon = Polygon::default();
    for corner in [u + v, v - u, -u - v, u - v] {
        polygon.add(centre + corner);
    }
    polygon
}

fn same(one: Vec3, other: Vec3) -> bool {
    (one - other).truncate().length_squared() < 4.0 * SLIP * SLIP
}

#[derive(Clone, Copy, Default)]
struct Polygon {
    points: [Vec3; MAX_POINTS],
    len: usize,
}

impl Polygon {
    fn add(&mut self, point: Vec3) {
        // Four corners clipped by four lines are eight at most.
        if self.len < MAX_POINTS {
            self.points[self.len] = point;
            self.len += 1;
        }
    }

    fn as_slice(&self) -> &[Vec3] {
        &self.points[..self.len]
    }

    fn map(mut self, to: impl Fn(Vec3) -> Vec3) -> Polygon {
        for point in &mut self.points[..self.len] {
            *point = to(*point);
        }
        self
    }

    /// Cuts off what is more than `limit` along an axis (Sutherland and Hodgman 1974).
    fn clip(&mut self, axis: Vec3, limit: f32) {
        let beyond = |point: Vec3| match axis.dot(point) - limit {
            slip if slip.abs() < SLIP => 0.0,
            beyond => beyond,
        };
        let whole = std::mem::take(self);
        for (index, &point) in whole.as_slice().iter().enumerate() {
            let next = whole.points[(index + 1) % whole.len];
            let (from, to) = (beyond(point), beyond(next));
            if from <= 0.0 {
                self.add(point);
            }
            if from * to < 0.0 {
                self.add(point.lerp(next, from / (from - to)));
            }
        }
    }
}
