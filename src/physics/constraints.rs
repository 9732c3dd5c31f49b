//! Joint limits and contacts as rows of a soft constraint problem (Todorov, "Convex and analytically
//! invertible dynamics with contacts and constraints", ICRA 2014, as MuJoCo computes it).

use super::collision::DetectedContacts;
use super::drive::rotation_vector;
use super::factor::{LANES, solve_lt_lanes};
use super::kinematics::{origin, quaternion};
use super::model::{JointKind, Model, SolverParams};
use super::spatial::Spatial;
use glam::Vec3;

/// The least regularisation, 1/kg: what nothing can move is not divided by zero, and the forces on it are such
/// that single precision can tell those of opposite edges apart. MuJoCo's, in double precision, is 1e-15.
const MIN_REGULARIZATION: f32 = 1e-6;

/// Directions of a contact: the normal and two tangents.
pub const DIRECTIONS: usize = 3;

/// A row's numbers, in lanes.
pub type Lane = [f32; 8];

/// Rows of the constraint problem, `[rows][stride]`, each a vector over the degrees of freedom padded with
/// zeros.
#[derive(Clone, Debug, Default)]
pub struct ConstraintRows {
    /// Lanes of a row: degrees of freedom divided by 8, rounded up.
    pub stride: usize,
    /// Number of rows (MuJoCo's `nefc`).
    pub len: usize,
    /// How degrees of freedom move the constrained distance, J; whitened once all are there, which is also
    /// how a unit force along the row accelerates them.
    pub values: Vec<Lane>,
}

/// A joint at the end of its range: one row.
#[derive(Clone, Copy, Debug, Default)]
pub struct LimitConstraint {
    /// Index of the joint in [`Model::joints`].
    pub joint: usize,
    /// Index of its row in [`ConstraintRows`].
    pub row: usize,
    /// Acceleration that it demands.
    pub target: f32,
    /// Regularisation R, added to the row's own response.
    pub regularization: f32,
    /// Torque back into the range, Nm, never negative; before the solver runs, that of the last step.
    pub force: f32,
}

/// A point of contact: a row for the normal, and one for each tangent.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactConstraint {
    /// Index of the normal's row in [`ConstraintRows`]; the rows of the two tangents follow it.
    pub row: usize,
    /// 0 if it slides freely.
    pub friction: f32,
    /// Acceleration that it demands along its directions.
    pub target: [f32; DIRECTIONS],
    /// Regularisation R of every edge.
    pub regularization: f32,
    /// Forces of the pyramid's edges: normal plus and minus friction times each tangent; without
    /// friction the first alone.
    pub forces: [f32; 4],
}

/// Spring and damper of a constraint (stiffness, damping), and its impedance, at `distance`.
fn response(params: &SolverParams, distance: f32, dt: f32) -> ([f32; 2], f32) {
    let [low, high, width, middle, power] = params.solimp;
    let (low, high) = (low.clamp(1e-4, 0.9999), high.clamp(1e-4, 0.9999));
    // MuJoCo's `refsafe`: no stiffer than two steps can follow.
    let time = params.solref[0].max(2.0 * dt);
    let ratio = params.solref[1];
    let stiffness = 1.0 / (high * high * time * time * ratio * ratio);
    let damping = 2.0 / (high * time);
    let x = (distance.abs() / width.max(1e-15)).min(1.0);
    let rise = if power == 1.0 {
        x
    } else if x <= middle {
        x.powf(power) / middle.powf(power - 1.0)
    } else {
        1.0 - (1.0 - x).powf(power) / (1.0 - middle).powf(power - 1.0)
    };
    ([stiffness, damping], low + rise * (high - low))
}

impl ConstraintRows {
    /// No rows, of `dofs` degrees of freedom.
    pub fn new(dofs: usize) -> ConstraintRows {
        ConstraintRows {
            stride: dofs.div_ceil(LANE),
            ..ConstraintRows::default()
        }
    }

    /// Removes all rows and keeps their memory.
    pub fn clear(&mut self) {
        self.len = 0;
        self.values.clear();
    }

    /// Adds a row of zeros and returns its index.
    pub fn add(&mut self) -> usize {
        self.len += 1;
        self.values.resize(self.len * self.stride, [0.0; LANE]);
        self.len - 1
    }

    /// Entries of a row, `[8 * stride]`, one for each degree of freedom and zeros behind them.
    pub fn row(&self, row: usize) -> &[f32] {
        self.values[row * self.stride..][..self.stride].as_flattened()
    }

    /// Mutable entries of a row, laid out as in [`row`](Self::row).
    pub fn row_mut(&mut self, row: usize) -> &mut [f32] {
        self.values[row * self.stride..][..self.stride].as_flattened_mut()
    }

    fn velocity(&self, row: usize, v: &[f32]) -> f32 {
        self.row(row).iter().zip(v).map(|(j, v)| j * v).sum()
    }

    /// Whitens all rows: J becomes J L^-1. `block` is scratch, `[dofs]`.
    pub fn whiten(
        &mut self,
        model: &Model,
        columns: &[usize],
        factors: &[f32],
        block: &mut [[f32; LANES]],
    ) {
        for first in (0..self.len).step_by(LANES) {
            let lanes = LANES.min(self.len - first);
            for lane in 0..lanes {
                for (x, value) in block.iter_mut().zip(self.row(first + lane)) {
                    x[lane] = *value;
                }
            }
            for x in block.iter_mut() {
                x[lanes..].fill(0.0);
            }
            solve_lt_lanes(model, columns, factors, block);
            for lane in 0..lanes {
                for (value, x) in self.row_mut(first + lane).iter_mut().zip(block.iter()) {
                    *value = x[lane];
                }
            }
        }
    }
}

const LANE: usize = std::mem::size_of::<Lane>() / 4;

/// Adds a row for every joint that is past its range. `forces`, `[joints]`, are those of the step
/// before.
pub fn limit_constraints(
    model: &Model,
    q: &[f32],
    v: &[f32],
    forces: &[f32],
    dt: f32,
    rows: &mut ConstraintRows,
    limits: &mut Vec<LimitConstraint>,
) {
    for (index, joint) in model.joints.iter().enumerate() {
        let Some([low, high]) = joint.range else {
            continue;
        };
        let (distance, axis) = match joint.kind {
            JointKind::Ball => {
                let rotation = rotation_vector(quaternion(&q[joint.q..]).normalize());
                (high - rotation.length(), -rotation.normalize_or_zero())
            }
            _ => {
                let angle = q[joint.q];
                match angle - low < high - angle {
                    true => (angle - low, Vec3::X),
                    false => (high - angle, Vec3::NEG_X),
                }
            }
        };
        if distance >= 0.0 {
            continue;
        }
        let row = rows.add();
        let dofs = joint.kind.nv();
        let axis = axis.to_array();
        rows.row_mut(row)[joint.v..][..dofs].copy_from_slice(&axis[..dofs]);
        let ([stiffness, damping], impedance) = response(&joint.solver_params, distance, dt);
        let inverse_mass = model.dofs[joint.v].invweight0;
        limits.push(LimitConstraint {
            joint: index,
            row,
            target: -damping * rows.velocity(row, v) - stiffness * impedance * distance,
            regularization: ((1.0 - impedance) / impedance * inverse_mass).max(MIN_REGULARIZATION),
            force: forces[index],
        });
    }
}

/// Adds the rows of every contact. `warm_start` finds a contact's forces of the step before by its id.
pub fn contact_constraints(
    model: &Model,
    q: &[f32],
    v: &[f32],
    axes: &[Spatial],
    found: &DetectedContacts,
    warm_start: impl Fn(u32) -> [f32; 4],
    dt: f32,
    rows: &mut ConstraintRows,
    contacts: &mut Vec<ContactConstraint>,
) {
    for (point, &id) in found.points.iter().zip(&found.ids) {
        let [first, second] = model.pairs[(id / 8) as usize].map(|geom| &model.geoms[geom]);
        let (friction, params) = first.mixed(second);
        let directions = [
            point.normal,
            point.tangent,
            point.normal.cross(point.tangent),
        ];
        let row = rows.add();
        rows.add();
        rows.add();
        for (geom, sign) in [(second, 1.0), (first, -1.0)] {
            if let Some(body) = geom.body {
                add_point(
                    model,
                    q,
                    axes,
                    body,
                    point.position,
                    directions.map(|d| d * sign),
                    row,
                    rows,
                );
            }
        }
        let ([stiffness, damping], impedance) = response(&params, point.distance, dt);
        let inverse_mass = model.invweight0(first) + model.invweight0(second);
        let regular = (1.0 - impedance) / impedance * inverse_mass;
        let speed = |direction| rows.velocity(row + direction, v);
        contacts.push(ContactConstraint {
            row,
            friction,
            target: [
                -damping * speed(0) - stiffness * impedance * point.distance,
                -damping * speed(1),
                -damping * speed(2),
            ],
            regularization: match friction > 0.0 {
                true => 2.0 * friction * friction * (1.0 + friction * friction) * regular,
                false => regular,
            }
            .max(MIN_REGULARIZATION),
            forces: warm_start(id),
        });
    }
}

/// Adds to three rows how a point of a body moves along three directions.
fn add_point(
    model: &Model,
    q: &[f32],
    axes: &[Spatial],
    body: usize,
    point: Vec3,
    directions: [Vec3; DIRECTIONS],
    row: usize,
    rows: &mut ConstraintRows,
) {
    let arm = point - origin(model, model.bodies[body].tree, q);
    let stride = rows.stride * LANE;
    let values = &mut rows.values.as_flattened_mut()[row * stride..][..DIRECTIONS * stride];
    for dof in model.dof_ancestors(model.bodies[body].last_dof) {
        let motion = axes[dof].at(arm);
        for (k, direction) in directions.iter().enumerate() {
            values[k * stride + dof] += motion.dot(*direction);
        }
    }
}
