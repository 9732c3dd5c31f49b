//! A compiled model: trees of rigid bodies as flat arrays, parents first.
//!
//! Metres, kilograms, seconds, radians, newtons; z is up. A body's frame is where its MJCF element
//! puts it; joints, shapes and the centre of mass are given in it. Positions `q` and velocities `v`
//! of a world follow MuJoCo's conventions: a free joint has its position and quaternion (w, x, y, z)
//! in `q`, and in `v` its linear velocity in the world's frame and its angular velocity in the
//! body's; a ball joint a quaternion, and its angular velocity in the body's frame; a hinge its angle.

use super::pose::Pose;
use glam::{Mat3, Quat, Vec3};
use std::ops::Range;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    pub name: String,
    pub bodies: Vec<Body>,
    /// In the order of their bodies; a body may have several hinges, the first nearest its parent.
    pub joints: Vec<Joint>,
    pub dofs: Vec<Dof>,
    pub geoms: Vec<Geom>,
    /// One for each body without a parent.
    pub trees: Vec<Tree>,
    /// Pairs of geoms that may touch: the one whose shape comes first in [`Shape`] comes first.
    pub pairs: Vec<[usize; 2]>,
    /// Positions at the start, as the file has them.
    pub start: Vec<f32>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Body {
    pub name: String,
    pub parent: Option<usize>,
    /// In the parent's frame, all joints at zero.
    pub place: Vec3,
    pub turn: Quat,
    pub mass: f32,
    /// Centre of mass.
    pub centre: Vec3,
    /// About the centre of mass, along the body's axes, kg m^2.
    pub inertia: Mat3,
    pub joints: Range<usize>,
    pub dofs: Range<usize>,
    pub tree: usize,
    /// Of its own degrees of freedom or, welded, of the nearest ancestor's that has some.
    pub last_dof: Option<usize>,
    /// Mean inverse mass that a force at the centre of mass meets at the start, 1/kg (MuJoCo's
    /// `body_invweight0`, translation).
    pub looseness: f32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Free,
    Ball,
    Hinge,
}

impl Kind {
    pub fn positions(self) -> usize {
        match self {
            Kind::Free => 7,
            Kind::Ball => 4,
            Kind::Hinge => 1,
        }
    }

    pub fn dofs(self) -> usize {
        match self {
            Kind::Free => 6,
            Kind::Ball => 3,
            Kind::Hinge => 1,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    pub name: String,
    pub kind: Kind,
    pub body: usize,
    /// Anchor in the body's frame.
    pub place: Vec3,
    /// Of a hinge: unit, in the body's frame.
    pub axis: Vec3,
    /// Of a hinge its smallest and largest angle, of a ball zero and its largest; rad.
    pub range: Option<[f32; 2]>,
    pub softness: Softness,
    /// First of its positions in `q`.
    pub q: usize,
    /// First of its degrees of freedom in `v`.
    pub v: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Dof {
    pub joint: usize,
    pub body: usize,
    /// The next one towards the root.
    pub parent: Option<usize>,
    /// Of this and all on the way to the root: `depth` entries of a row of the mass matrix.
    pub depth: usize,
    /// Where its row begins in the packed mass matrix: itself, its parent, and so on to the root.
    pub row: usize,
    /// kg m^2 (kg for translations).
    pub armature: f32,
    pub drive: Option<Drive>,
    /// Inverse inertia that a force at it meets at the start (MuJoCo's `dof_invweight0`).
    pub looseness: f32,
}

/// Proportional-derivative control of one degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Nm/rad
    pub stiffness: f32,
    /// Nm s/rad
    pub damping: f32,
    /// Largest torque, Nm.
    pub limit: f32,
}

/// How a constraint gives way (MuJoCo's `solref` and `solimp`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Softness {
    /// Time constant (s) and damping ratio.
    pub spring: [f32; 2],
    /// Impedance at depth zero and at `width`, width (m or rad), midpoint, power.
    pub impedance: [f32; 5],
}

impl Default for Softness {
    fn default() -> Self {
        Softness {
            spring: [0.02, 1.0],
            impedance: [0.9, 0.95, 0.001, 0.5, 2.0],
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// The half space below z = 0 of its frame.
    Plane,
    Sphere {
        radius: f32,
    },
    /// Along z; `half` is half the distance of the two centres.
    Capsule {
        radius: f32,
        half: f32,
    },
    Box {
        half: Vec3,
    },
}

#[derive(Clone, Debug, PartialEq)]
pub struct Geom {
    pub name: String,
    /// `None` for what stands still.
    pub body: Option<usize>,
    pub shape: Shape,
    /// In the body's frame.
    pub place: Vec3,
    pub turn: Quat,
    /// Coefficient of sliding friction; a pair has the larger of two.
    pub friction: f32,
    /// Slides without friction, unless its partner does not (`condim` 1).
    pub slippery: bool,
    pub softness: Softness,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    pub bodies: Range<usize>,
    pub dofs: Range<usize>,
}

impl Model {
    pub fn positions(&self) -> usize {
        self.joints.iter().map(|joint| joint.kind.positions()).sum()
    }

    pub fn velocities(&self) -> usize {
        self.dofs.len()
    }

    /// A degree of freedom and those on its way to the root.
    #[inline]
    pub fn way(&self, dof: Option<usize>) -> impl Iterator<Item = usize> {
        std::iter::successors(dof, |&dof| self.dofs[dof].parent)
    }

    /// Entries of the packed mass matrix.
    pub fn packed(&self) -> usize {
        self.dofs.iter().map(|dof| dof.depth).sum()
    }

    pub fn mass(&self) -> f32 {
        self.bodies.iter().map(|body| body.mass).sum()
    }

    /// Degrees of freedom that are driven: the targets of an action.
    pub fn driven(&self) -> usize {
        self.dofs.iter().filter(|dof| dof.drive.is_some()).count()
    }

    /// Of what a geom hangs on; none for what stands still.
    pub fn looseness(&self, geom: &Geom) -> f32 {
        geom.body.map_or(0.0, |body| self.bodies[body].looseness)
    }

    pub fn body(&self, name: &str) -> Option<usize> {
        self.bodies.iter().position(|body| body.name == name)
    }
}

/// The least friction of geoms that are not both slippery (MuJoCo's mjMINMU).
const SLIGHTEST: f32 = 1e-5;

impl Geom {
    /// In the world, its body's pose being among `poses`, `[bodies]`.
    pub fn pose(&self, poses: &[Pose]) -> Pose {
        let own = Pose {
            place: self.place,
            turn: self.turn,
        };
        self.body.map_or(own, |body| poses[body] * own)
    }

    /// Friction and softness where two geoms touch.
    pub fn mixed(&self, other: &Geom) -> (f32, Softness) {
        let friction = match self.slippery && other.slippery {
            true => 0.0,
            false => self.friction.max(other.friction).max(SLIGHTEST),
        };
        let mean = |a: f32, b: f32| 0.5 * (a + b);
        let (a, b) = (&self.softness, &other.softness);
        let softness = Softness {
            spring: std::array::from_fn(|i| mean(a.spring[i], b.spring[i])),
            impedance: std::array::from_fn(|i| mean(a.impedance[i], b.impedance[i])),
        };
        (friction, softness)
    }
}
