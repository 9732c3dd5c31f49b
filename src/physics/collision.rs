//! Where the shapes of a world touch, as MuJoCo finds it: points midway between two surfaces.

mod box_box;
mod plane;
mod capsule;
mod capsule_box;

use super::model::{Geom, Model, Shape};
use super::pose::Pose;
use glam::{Mat3, Vec3};

/// A point where one shape reaches into another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch {
    /// Midway between the two surfaces.
    pub place: Vec3,
    /// From the first shape to the second.
    pub normal: Vec3,
    /// Across the normal; the second tangent is normal x tangent.
    pub tangent: Vec3,
    /// Negative: how deep they reach into each other.
    pub distance: f32,
}

impl Touch {
    fn new(place: Vec3, normal: Vec3, distance: f32) -> Touch {
        let tangent = match normal.y.abs() < 0.5 {
            true => across(normal, Vec3::Y),
            false => across(normal, Vec3::Z),
        };
        Touch {
            place,
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

/// Points of contact that a pair has at most.
pub const MOST: usize = 8;

/// The touches of a pair.
#[derive(Clone, Copy, Debug, Default)]
pub struct Touches {
    touches: [Touch; MOST],
    numbers: [u32; MOST],
    len: usize,
}

impl Touches {
    /// Adds a touch, unless it does not touch. Its number, less than [`MOST`], tells it from the
    /// others of the pair, from step to step.
    fn add(&mut self, number: usize, touch: Touch) {
        if touch.distance < 0.0 && self.len < MOST {
            self.touches[self.len] = touch;
            self.numbers[self.len] = number as u32;
            self.len += 1;
        }
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    pub fn as_slice(&self) -> &[Touch] {
        &self.touches[..self.len]
    }

    pub fn numbers(&self) -> &[u32] {
        &self.numbers[..self.len]
    }
}

/// A geom in the world.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    pub shape: Shape,
    pub place: Vec3,
    pub turn: Mat3,
}

/// A capsule in the world, or a sphere: one of no length.
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
    turn: Mat3,
    half: Vec3,
}

impl Placed {
    fn of(geom: &Geom, poses: &[Pose]) -> Placed {
        let pose = geom.pose(poses);
        Placed {
            shape: geom.shape,
            place: pose.place,
            turn: Mat3::from_quat(pose.turn),
        }
    }

    fn capsule(&self) -> Capsule {
        let (radius, half) = match self.shape {
            Shape::Sphere { radius } => (radius, 0.0),
            Shape::Capsule { radius, half } => (radius, half),
            _ => unreachable!("a round shape"),
        };
        Capsule {
            centre: self.place,
            axis: self.turn.z_axis,
            half,
            radius,
        }
    }

    fn cuboid(&self, half: Vec3) -> Cuboid {
        Cuboid {
            centre: self.place,
            turn: self.turn,
            half,
        }
    }

    /// Whether a sphere around the other leaves no doubt that they do not touch.
    fn clear_of(&self, other: &Placed, reach: f32) -> bool {
        let between = other.place - self.place;
        match self.shape {
            Shape::Plane => self.turn.z_axis.dot(between) > reach,
            _ => between.length_squared() > reach * reach,
        }
    }
}

/// Pairs of shapes that are compared alike, in the order in which a model has its pairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    PlaneRound,
    PlaneBox,
    RoundRound,
    RoundBox,
    BoxBox,
}

impl Family {
    /// Of two shapes, the first of which comes first in [`Shape`]. Two planes, which never meet, count as
    /// if the second were round.
    pub fn of(shapes: [Shape; 2]) -> Family {
        match shapes {
            [Shape::Plane, Shape::Box { .. }] => Family::PlaneBox,
            [Shape::Plane, _] => Family::PlaneRound,
            [Shape::Box { .. }, _] => Family::BoxBox,
            [_, Shape::Box { .. }] => Family::RoundBox,
            _ => Family::RoundRound,
        }
    }
}

/// Adds the touches of two shapes, the first of which comes first in [`Shape`].
pub fn collide(first: &Placed, second: &Placed, out: &mut Touches) {
    match (first.shape, second.shape) {
        (_, Shape::Plane) => {}
        (Shape::Plane, Shape::Box { half }) => plane::cuboid(first, &second.cuboid(half), out),
        (Shape::Plane, _) => plane::capsule(first, &second.capsule(), out),
        (Shape::Box { half: one }, Shape::Box { half: other }) => {
            box_box::box_box(&first.cuboid(one), &second.cuboid(other), out);
        }
        (_, Shape::Box { half }) => {
            capsule_box::round_box(&first.capsule(), &second.cuboid(half), out);
        }
        _ => capsule::round_round(&first.capsule(), &second.capsule(), out),
    }
}

/// The contacts of a world.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    pub touches: Vec<Touch>,
    /// Of each touch its pair times [`MOST`] plus its number in the pair: the same from step to step.
    pub keys: Vec<u32>,
    /// Touches that found no slot.
    pub overflow: u32,
    geoms: Vec<(Placed, f32)>,
}

/// Radius of a sphere that holds a shape; of a plane none.
pub fn reach(shape: Shape) -> f32 {
    match shape {
        Shape::Plane => 0.0,
        Shape::Sphere { radius } => radius,
        Shape::Capsule { radius, half } => radius + half,
        Shape::Box { half } => half.length(),
    }
}

/// Finds the contacts of a world whose bodies have these poses, the first `slots` of them in the
/// order of the model's pairs.
pub fn find(model: &Model, poses: &[Pose], slots: usize, out: &mut Contacts) {
    out.touches.clear();
    out.keys.clear();
    out.overflow = 0;
    out.geoms.clear();
    let geoms = model.geoms.iter();
    out.geoms
        .extend(geoms.map(|geom| (Placed::of(geom, poses), reach(geom.shape))));
    let mut touches = Touches::default();
    for (pair, &[first, second]) in model.pairs.iter().enumerate() {
        let ((first, one), (second, other)) = (&out.geoms[first], &out.geoms[second]);
        if first.clear_of(second, one + other) {
            continue;
        }
        touches.clear();
        collide(first, second, &mut touches);
        let free = slots - out.touches.len();
        let kept = touches.len.min(free);
        out.touches.extend_from_slice(&touches.as_slice()[..kept]);
        let numbers = &touches.numbers()[..kept];
        out.keys
            .extend(numbers.iter().map(|number| (pair * MOST) as u32 + number));
        out.overflow += (touches.len - kept) as u32;
    }
}
