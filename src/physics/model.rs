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

/// A compiled model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// Name in the file, empty if it has none; of several models in one world, theirs joined by ` + `.
    pub name: String,
    /// Parents before their children.
    pub bodies: Vec<Body>,
    /// Joints in the order of their bodies; a body may have several hinges, the first nearest its parent.
    pub joints: Vec<Joint>,
    /// Degrees of freedom in the order of their joints, `[nv]`.
    pub dofs: Vec<Dof>,
    /// Shapes that may touch something, on bodies or standing still (MuJoCo's `geom`).
    pub geoms: Vec<Geom>,
    /// One tree for each body without a parent.
    pub trees: Vec<KinematicTree>,
    /// Pairs of geoms that may touch: the one whose shape comes first in [`GeomShape`] comes first.
    pub pairs: Vec<[usize; 2]>,
    /// Positions at the start, as the file has them.
    pub qpos0: Vec<f32>,
}

/// A rigid body that can move. Bodies fixed to the world are left out, but for their geoms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Body {
    /// Name in the file, empty if it has none.
    pub name: String,
    /// Index of the parent, none for the root of a tree (MuJoCo's `body_parentid`).
    pub parent: Option<usize>,
    /// In the parent's frame, all joints at zero.
    pub position: Vec3,
    /// Rotation in the parent's frame or, of a root, the world's, all joints at zero (MuJoCo's `body_quat`).
    pub rotation: Quat,
    /// Mass without that of its children, kg (MuJoCo's `body_mass`).
    pub mass: f32,
    /// Centre of mass.
    pub com: Vec3,
    /// About the centre of mass, along the body's axes, kg m^2.
    pub inertia: Mat3,
    /// Indices of its joints in [`Model::joints`], empty if it is welded to its parent.
    pub joints: Range<usize>,
    /// Indices of its own degrees of freedom in [`Model::dofs`].
    pub dofs: Range<usize>,
    /// Index of its tree in [`Model::trees`] (MuJoCo's `body_treeid`).
    pub tree: usize,
    /// Last of its own degrees of freedom or, if it is welded, of the nearest ancestor's that has some.
    pub last_dof: Option<usize>,
    /// Mean inverse mass that a force at the centre of mass meets at the start, 1/kg (MuJoCo's
    /// `body_invweight0`, translation).
    pub invweight0: f32,
}

/// How a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Any translation and rotation: six degrees of freedom, of a root alone (MuJoCo's `mjJNT_FREE`).
    Free,
    /// Any rotation about the anchor: three degrees of freedom (MuJoCo's `mjJNT_BALL`).
    Ball,
    /// Rotation about one axis through the anchor (MuJoCo's `mjJNT_HINGE`).
    Hinge,
}

impl JointKind {
    /// Positions in `q`.
    pub fn nq(self) -> usize {
        match self {
            JointKind::Free => 7,
            JointKind::Ball => 4,
            JointKind::Hinge => 1,
        }
    }

    /// Degrees of freedom.
    pub fn nv(self) -> usize {
        match self {
            JointKind::Free => 6,
            JointKind::Ball => 3,
            JointKind::Hinge => 1,
        }
    }
}

/// A joint between a body and its parent.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name in the file, empty if it has none.
    pub name: String,
    /// Which way it moves (MuJoCo's `jnt_type`).
    pub kind: JointKind,
    /// Index of the body that it moves (MuJoCo's `jnt_bodyid`).
    pub body: usize,
    /// Anchor in the body's frame, m.
    pub position: Vec3,
    /// Unit axis of a hinge, in the body's frame.
    pub axis: Vec3,
    /// Smallest and largest angle of a hinge, zero and the largest angle of a ball; rad.
    pub range: Option<[f32; 2]>,
    /// How its limit gives way.
    pub solver_params: SolverParams,
    /// First of its positions in `q`.
    pub q: usize,
    /// First of its degrees of freedom in `v`.
    pub v: usize,
}

/// A degree of freedom.
#[derive(Clone, Debug, PartialEq)]
pub struct Dof {
    /// Index of its joint (MuJoCo's `dof_jntid`).
    pub joint: usize,
    /// Index of the body that it moves (MuJoCo's `dof_bodyid`).
    pub body: usize,
    /// The next one towards the root.
    pub parent: Option<usize>,
    /// Number of degrees of freedom from this one to the root: entries of its row of the mass matrix.
    pub depth: usize,
    /// Where its row begins in the packed mass matrix: itself, its parent, and so on to the root.
    pub row: usize,
    /// Inertia added to its own, kg m^2 (kg for translations).
    pub armature: f32,
    /// Its own spring and damper, if it has any.
    pub spring: Option<JointSpring>,
    /// Its actuator, none if it is passive.
    pub drive: Option<Drive>,
    /// Inverse inertia that a force at it meets at the start (MuJoCo's `dof_invweight0`).
    pub invweight0: f32,
}

/// A passive spring and damper of one degree of freedom (MuJoCo's `jnt_stiffness` and `dof_damping`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSpring {
    /// Nm/rad
    pub stiffness: f32,
    /// Nm s/rad
    pub damping: f32,
    /// Where it rests, rad.
    pub rest: f32,
}

/// The actuator of one degree of freedom: proportional-derivative control to a target, or a motor, whose
/// control is a torque, or both (MuJoCo's fixed gain and affine bias).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Torque that a unit of the control adds, Nm; 0 if the control is the target alone.
    pub torque: f32,
    /// Of the pull towards the control as a target, Nm/rad; 0 of a motor.
    pub stiffness: f32,
    /// Nm s/rad
    pub damping: f32,
    /// Largest torque, Nm.
    pub limit: f32,
    /// Least and largest control: what is beyond counts as these.
    pub control: [f32; 2],
}

impl Drive {
    /// Control to a target, without a range of targets.
    pub fn to_target(stiffness: f32, damping: f32, limit: f32) -> Drive {
        Drive {
            torque: 0.0,
            stiffness,
            damping,
            limit,
            control: [f32::MIN, f32::MAX],
        }
    }
}

/// How a constraint gives way, as in MuJoCo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverParams {
    /// Time constant (s) and damping ratio.
    pub solref: [f32; 2],
    /// Impedance at depth zero and at `width`, width (m or rad), midpoint, power.
    pub solimp: [f32; 5],
}

impl Default for SolverParams {
    fn default() -> Self {
        SolverParams {
            solref: [0.02, 1.0],
            solimp: [0.9, 0.95, 0.001, 0.5, 2.0],
        }
    }
}

/// What a geom looks like to others. A sphere is compared as a capsule of zero length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GeomShape {
    /// The half space below z = 0 of its frame.
    Plane,
    /// A ball around the origin of its frame.
    Sphere {
        /// Radius, m.
        radius: f32,
    },
    /// A capsule along z; `half` is half the distance of the two centres.
    Capsule {
        /// Radius of the ends and of the cylinder between them, m.
        radius: f32,
        /// Half the length of the cylinder without the ends, m.
        half: f32,
    },
    /// `half` are half the lengths of its edges.
    Box {
        /// Half lengths along x, y and z of its frame, m.
        half: Vec3,
    },
}

/// A shape on a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Geom {
    /// Name in the file, empty if it has none.
    pub name: String,
    /// The body it moves with; none if it stands still.
    pub body: Option<usize>,
    /// Shape and sizes in its own frame (MuJoCo's `geom_type`, `geom_size`).
    pub shape: GeomShape,
    /// Position in the body's frame, m.
    pub position: Vec3,
    /// Rotation in the body's frame.
    pub rotation: Quat,
    /// Coefficient of sliding friction; a pair has the larger of two.
    pub friction: f32,
    /// Whether it slides without friction, unless its partner does not (`condim` 1).
    pub frictionless: bool,
    /// How its contacts give way.
    pub solver_params: SolverParams,
}

/// A body without a parent and all that hangs on it.
#[derive(Clone, Debug, PartialEq)]
pub struct KinematicTree {
    /// Indices in [`Model::bodies`], the root first.
    pub bodies: Range<usize>,
    /// Indices in [`Model::dofs`].
    pub dofs: Range<usize>,
}

impl Model {
    /// Positions of a world.
    pub fn nq(&self) -> usize {
        self.joints.iter().map(|joint| joint.kind.nq()).sum()
    }

    /// Velocities of a world: its degrees of freedom.
    pub fn nv(&self) -> usize {
        self.dofs.len()
    }

    /// A degree of freedom and its ancestors, up to the root.
    #[inline]
    pub fn dof_ancestors(&self, dof: Option<usize>) -> impl Iterator<Item = usize> {
        std::iter::successors(dof, |&dof| self.dofs[dof].parent)
    }

    /// Entries of the packed mass matrix.
    pub fn nm(&self) -> usize {
        self.dofs.iter().map(|dof| dof.depth).sum()
    }

    /// Mass of all bodies, kg.
    pub fn mass(&self) -> f32 {
        self.bodies.iter().map(|body| body.mass).sum()
    }

    /// Degrees of freedom that are driven.
    pub fn nu(&self) -> usize {
        self.dofs.iter().filter(|dof| dof.drive.is_some()).count()
    }

    /// Inverse weight of the body of a geom; zero for what stands still.
    pub fn invweight0(&self, geom: &Geom) -> f32 {
        geom.body.map_or(0.0, |body| self.bodies[body].invweight0)
    }

    /// Whether a body hangs on no other, and none on it.
    pub fn is_alone(&self, body: usize) -> bool {
        self.trees[self.bodies[body].tree].bodies.len() == 1
    }

    /// Index of a body by name.
    pub fn body(&self, name: &str) -> Option<usize> {
        self.bodies.iter().position(|body| body.name == name)
    }
}

/// The least friction of geoms that are not both frictionless (MuJoCo's mjMINMU).
const MIN_FRICTION: f32 = 1e-5;

impl Geom {
    /// Pose in the world, `poses`, `[bodies]`, being those of the bodies.
    pub fn pose(&self, poses: &[Pose]) -> Pose {
        let own = Pose {
            position: self.position,
            rotation: self.rotation,
        };
        self.body.map_or(own, |body| poses[body] * own)
    }

    /// Height of its lowest point in the world, m.
    pub fn lowest_point(&self, poses: &[Pose]) -> f32 {
        let pose = self.pose(poses);
        let up = pose.rotation.inverse() * Vec3::Z;
        let below = match self.shape {
            GeomShape::Plane => 0.0,
            GeomShape::Sphere { radius } => radius,
            GeomShape::Capsule { radius, half } => radius + half * up.z.abs(),
            GeomShape::Box { half } => half.dot(up.abs()),
        };
        pose.position.z - below
    }

    /// Friction and solver parameters where two geoms touch.
    pub fn mixed(&self, other: &Geom) -> (f32, SolverParams) {
        let friction = match self.frictionless && other.frictionless {
            true => 0.0,
            false => self.friction.max(other.friction).max(MIN_FRICTION),
        };
        let mean = |a: f32, b: f32| 0.5 * (a + b);
        let (a, b) = (&self.solver_params, &other.solver_params);
        let solver_params = SolverParams {
            solref: std::array::from_fn(|i| mean(a.solref[i], b.solref[i])),
            solimp: std::array::from_fn(|i| mean(a.solimp[i], b.solimp[i])),
        };
        (friction, solver_params)
    }
}
