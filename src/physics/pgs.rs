//! Projected Gauss-Seidel on the dual of the soft constraint problem: each limit and each edge of
//! each contact's friction pyramid in turn takes the force that is best for it alone, never a pull.

use super::constraints::{ConstraintRows, ContactConstraint, Lane, LimitConstraint};
use multiversion::multiversion;

/// Improves the forces by `iterations` rounds, and with them the whitened acceleration of the degrees of
/// freedom, `[stride]`. On entry `acceleration` is what it would be without constraints. `blocks` is scratch.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
pub fn pgs(
    rows: &ConstraintRows,
    iterations: u32,
    limits: &mut [LimitConstraint],
    contacts: &mut [ContactConstraint],
    acceleration: &mut [Lane],
    blocks: &mut Vec<ResponseBlock>,
) {
    blocks.clear();
    for limit in limits.iter() {
        blocks.push(one(rows, limit.row));
        apply_force(rows, limit.row, limit.force, acceleration);
    }
    for contact in contacts.iter() {
        blocks.push(three(rows, contact.row));
        for (k, force) in along(contact.friction, &contact.forces)
            .into_iter()
            .enumerate()
        {
            apply_force(rows, contact.row + k, force, acceleration);
        }
    }
    let (single, triple) = blocks.split_at(limits.len());
    for _ in 0..iterations {
        for (limit, block) in limits.iter_mut().zip(single) {
            let residual = limit.target - product(rows, limit.row, acceleration);
            let wanted = (residual - limit.regularization * limit.force)
                / (block[0][0] + limit.regularization);
            let force = (limit.force + wanted).max(0.0);
            apply_force(rows, limit.row, force - limit.force, acceleration);
            limit.force = force;
        }
        for (contact, block) in contacts.iter_mut().zip(triple) {
            let row_acc = products(rows, contact.row, acceleration);
            let change = relax(contact, block, row_acc);
            if change != [0.0; 3] {
                apply_forces(rows, contact.row, change, acceleration);
            }
        }
    }
}

/// How a contact's directions respond to forces along them.
pub type ResponseBlock = [[f32; 3]; 3];

/// The pyramid's edges: sign and direction of the tangent.
const EDGES: [(f32, usize); 4] = [(1.0, 1), (-1.0, 1), (1.0, 2), (-1.0, 2)];

/// Edge forces as forces along the normal and the tangents.
#[inline(always)]
pub fn along(friction: f32, forces: &[f32; 4]) -> [f32; 3] {
    match friction > 0.0 {
        true => [
            forces.iter().sum(),
            friction * (forces[0] - forces[1]),
            friction * (forces[2] - forces[3]),
        ],
        false => [forces[0], 0.0, 0.0],
    }
}

/// One visit to a contact that accelerates by `row_acc` along its directions. Sets its forces; returns
/// their change along the directions.
#[inline(always)]
fn relax(
    contact: &mut ContactConstraint,
    block: &ResponseBlock,
    mut row_acc: [f32; 3],
) -> [f32; 3] {
    let mut change = [0.0; 3];
    let friction = contact.friction;
    let edges = if friction > 0.0 { 4 } else { 1 };
    for (edge, &(sign, tangent)) in EDGES[..edges].iter().enumerate() {
        let slope = sign * friction;
        let residual =
            contact.target[0] - row_acc[0] + slope * (contact.target[tangent] - row_acc[tangent]);
        let diag = block[0][0]
            + 2.0 * slope * block[0][tangent]
            + slope * slope * block[tangent][tangent]
            + contact.regularization;
        let before = contact.forces[edge];
        let force = (before + (residual - contact.regularization * before) / diag).max(0.0);
        contact.forces[edge] = force;
        let more = force - before;
        change[0] += more;
        change[tangent] += slope * more;
        for (k, row_acc) in row_acc.iter_mut().enumerate() {
            *row_acc += more * (block[0][k] + slope * block[tangent][k]);
        }
    }
    change
}

#[inline(always)]
fn values(rows: &ConstraintRows, row: usize) -> &[Lane] {
    &rows.values[row * rows.stride..][..rows.stride]
}

#[inline(always)]
fn dot(a: &[Lane], b: &[Lane]) -> f32 {
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..8 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    total(sums)
}

#[inline(always)]
fn total(s: Lane) -> f32 {
    ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]))
}

#[inline(always)]
fn product(rows: &ConstraintRows, row: usize, acceleration: &[Lane]) -> f32 {
    dot(values(rows, row), acceleration)
}

#[inline(always)]
fn products(rows: &ConstraintRows, row: usize, acceleration: &[Lane]) -> [f32; 3] {
    std::array::from_fn(|k| product(rows, row + k, acceleration))
}

#[inline(always)]
fn apply_force(rows: &ConstraintRows, row: usize, force: f32, acceleration: &mut [Lane]) {
    for (a, r) in acceleration.iter_mut().zip(values(rows, row)) {
        for lane in 0..8 {
            a[lane] += force * r[lane];
        }
    }
}

#[inline(always)]
fn apply_forces(rows: &ConstraintRows, row: usize, forces: [f32; 3], acceleration: &mut [Lane]) {
    let [n, t, s] = [0, 1, 2].map(|k| values(rows, row + k));
    for (index, a) in acceleration.iter_mut().enumerate() {
        for lane in 0..8 {
            a[lane] += forces[0] * n[index][lane]
                + forces[1] * t[index][lane]
                + forces[2] * s[index][lane];
        }
    }
}

/// Response of a row to a force along it, in a block of one.
#[inline(always)]
pub fn one(rows: &ConstraintRows, row: usize) -> ResponseBlock {
    let mut block = [[0.0; 3]; 3];
    block[0][0] = dot(values(rows, row), values(rows, row));
    block
}

/// Response of a row and the two behind it.
#[inline(always)]
pub fn three(rows: &ConstraintRows, row: usize) -> ResponseBlock {
    let [n, t, s] = [0, 1, 2].map(|k| values(rows, row + k));
    let (nt, ns, ts) = (dot(n, t), dot(n, s), dot(t, s));
    [
        [dot(n, n), nt, ns],
        [nt, dot(t, t), ts],
        [ns, ts, dot(s, s)],
    ]
}
