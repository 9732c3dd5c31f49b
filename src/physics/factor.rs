//! M = L^T L, with L as sparse as the tree: Featherstone, "Efficient Factorization of the
//! Joint-Space Inertia Matrix for Branched Kinematic Trees", IJRR 24(6), 2005.
//!
//! In the mass-weighted coordinates L a the mass matrix is one: a force J^T f accelerates by
//! L^-T J^T f, and the same vector L^-T J^T says what its constraint notices of an acceleration.

use super::model::Model;
use multiversion::multiversion;

/// For every entry of the packed mass matrix its column: the degree of freedom itself, its parent,
/// and so on to the root.
pub fn columns(model: &Model) -> Vec<usize> {
    let dofs = 0..model.dofs.len();
    dofs.flat_map(|dof| model.dof_ancestors(Some(dof)))
        .collect()
}

/// Turns a packed mass matrix into its factor L, the diagonal inverted.
#[inline]
pub fn factor(model: &Model, columns: &[usize], matrix: &mut [f32]) {
    for dof in model.dofs.iter().rev() {
        let (above, row) = matrix.split_at_mut(dof.row);
        let row = &mut row[..dof.depth];
        row[0] = 1.0 / row[0].sqrt();
        for k in 1..dof.depth {
            row[k] *= row[0];
        }
        for k in 1..dof.depth {
            let ancestor = &model.dofs[columns[dof.row + k]];
            let target = &mut above[ancestor.row..][..ancestor.depth];
            for (entry, along) in target.iter_mut().zip(&row[k..]) {
                *entry -= row[k] * along;
            }
        }
    }
}

/// x = L^-T x: a force over the degrees of freedom, `[dofs]`, becomes a mass-weighted acceleration.
#[inline]
pub fn solve_lt(model: &Model, columns: &[usize], factors: &[f32], x: &mut [f32]) {
    for (index, dof) in model.dofs.iter().enumerate().rev() {
        let value = x[index] * factors[dof.row];
        x[index] = value;
        for k in 1..dof.depth {
            x[columns[dof.row + k]] -= factors[dof.row + k] * value;
        }
    }
}

/// x = L^-1 x: a mass-weighted acceleration becomes one of the degrees of freedom, `[dofs]`.
#[inline]
pub fn solve_l(model: &Model, columns: &[usize], factors: &[f32], x: &mut [f32]) {
    for (index, dof) in model.dofs.iter().enumerate() {
        let mut value = x[index];
        for k in 1..dof.depth {
            value -= factors[dof.row + k] * x[columns[dof.row + k]];
        }
        x[index] = value * factors[dof.row];
    }
}

/// Vectors weighed side by side.
pub const LANES: usize = 16;

/// [`solve_lt`] for `LANES` vectors, `x` being `[dofs][LANES]`.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
pub fn solve_lt_lanes(model: &Model, columns: &[usize], factors: &[f32], x: &mut [[f32; LANES]]) {
    for (index, dof) in model.dofs.iter().enumerate().rev() {
        let value = x[index].map(|value| value * factors[dof.row]);
        x[index] = value;
        for k in 1..dof.depth {
            let factor = factors[dof.row + k];
            let target = &mut x[columns[dof.row + k]];
            for lane in 0..LANES {
                target[lane] -= factor * value[lane];
            }
        }
    }
}
