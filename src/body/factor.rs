//! M = L^T D L, with L as sparse as the tree: Featherstone, "Efficient Factorization of the
//! Joint-Space Inertia Matrix for Branched Kinematic Trees", IJRR 24(6), 2005.

use super::model::Model;
use multiversion::multiversion;

/// For every entry of the packed mass matrix its column: the degree of freedom itself, its parent,
/// and so on to the root.
pub fn columns(model: &Model) -> Vec<usize> {
    let way = |dof| std::iter::successors(Some(dof), |&dof: &usize| model.dofs[dof].parent);
    (0..model.dofs.len()).flat_map(way).collect()
}

/// Turns a packed mass matrix into its factors: D in the diagonal's place, L below it.
#[inline]
pub fn factor(model: &Model, columns: &[usize], matrix: &mut [f32]) {
    for dof in model.dofs.iter().rev() {
        let (above, row) = matrix.split_at_mut(dof.row);
        let row = &mut row[..dof.depth];
        let inverse = 1.0 / row[0];
        for k in 1..dof.depth {
            let scaled = row[k] * inverse;
            let ancestor = &model.dofs[columns[dof.row + k]];
            let target = &mut above[ancestor.row..][..ancestor.depth];
            for (entry, along) in target.iter_mut().zip(&row[k..]) {
                *entry -= scaled * along;
            }
        }
        for entry in &mut row[1..] {
            *entry *= inverse;
        }
    }
}

/// Right-hand sides solved side by side.
pub const LANES: usize = 16;

/// Solves for `x`, `[dofs]`, in place.
#[inline]
pub fn solve(model: &Model, columns: &[usize], factors: &[f32], x: &mut [f32]) {
    for (index, dof) in model.dofs.iter().enumerate().rev() {
        let value = x[index];
        for k in 1..dof.depth {
            x[columns[dof.row + k]] -= factors[dof.row + k] * value;
        }
    }
    for (index, dof) in model.dofs.iter().enumerate() {
        let mut value = x[index] / factors[dof.row];
        for k in 1..dof.depth {
            value -= factors[dof.row + k] * x[columns[dof.row + k]];
        }
        x[index] = value;
    }
}

/// [`solve`] for `LANES` right-hand sides, `x` being `[dofs][LANES]`.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
pub fn solve_lanes(model: &Model, columns: &[usize], factors: &[f32], x: &mut [[f32; LANES]]) {
    for (index, dof) in model.dofs.iter().enumerate().rev() {
        let value = x[index];
        for k in 1..dof.depth {
            let factor = factors[dof.row + k];
            let target = &mut x[columns[dof.row + k]];
            for lane in 0..LANES {
                target[lane] -= factor * value[lane];
            }
        }
    }
    for (index, dof) in model.dofs.iter().enumerate() {
        let inverse = 1.0 / factors[dof.row];
        let mut value = x[index].map(|value| value * inverse);
        for k in 1..dof.depth {
            let factor = factors[dof.row + k];
            let source = &x[columns[dof.row + k]];
            for lane in 0..LANES {
                value[lane] -= factor * source[lane];
            }
        }
        x[index] = value;
    }
}
