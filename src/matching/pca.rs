//! Principal axes of the trajectory features. Their twelve numbers are correlated (three positions and
//! directions of one path), so boxes along these axes are far tighter than along the features'.

use crate::motion::features::{POSE_DIM, ROW_STRIDE, TRAJECTORY_DIM};

/// Axes of falling variance, orthonormal to the last bits of f64.
pub struct PrincipalAxes([[f64; TRAJECTORY_DIM]; TRAJECTORY_DIM]);

impl PrincipalAxes {
    /// Axes of the trajectories of `rows`, of which there must be at least one.
    pub fn of(rows: &[[f32; ROW_STRIDE]]) -> Self {
        let (values, vectors) = eigen(covariance(rows));
        let mut order: [usize; TRAJECTORY_DIM] = std::array::from_fn(|i| i);
        order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
        PrincipalAxes(order.map(|axis| vectors.map(|row| row[axis])))
    }

    /// The axes in single precision, one a row.
    pub fn rows(&self) -> [[f32; TRAJECTORY_DIM]; TRAJECTORY_DIM] {
        self.0.map(|axis| axis.map(|value| value as f32))
    }

    /// Coordinates of a row's trajectory along the axes.
    pub fn project(&self, row: &[f32; ROW_STRIDE]) -> [f32; TRAJECTORY_DIM] {
        let trajectory: [f64; TRAJECTORY_DIM] =
            std::array::from_fn(|i| f64::from(row[POSE_DIM + i]));
        self.0.map(|axis| {
            let mut sum = 0.0;
            for (a, t) in axis.iter().zip(trajectory) {
                sum += a * t;
            }
            sum as f32
        })
    }
}

type Matrix = [[f64; TRAJECTORY_DIM]; TRAJECTORY_DIM];

fn covariance(rows: &[[f32; ROW_STRIDE]]) -> Matrix {
    let n = rows.len() as f64;
    let at = |row: &[f32; ROW_STRIDE], i: usize| f64::from(row[POSE_DIM + i]);
    let mean: [f64; TRAJECTORY_DIM] =
        std::array::from_fn(|i| rows.iter().map(|row| at(row, i)).sum::<f64>() / n);
    let mut matrix = [[0.0; TRAJECTORY_DIM]; TRAJECTORY_DIM];
    for row in rows {
        let away: [f64; TRAJECTORY_DIM] = std::array::from_fn(|i| at(row, i) - mean[i]);
        for (line, a) in matrix.iter_mut().zip(away) {
            for (sum, b) in line.iter_mut().zip(away) {
                *sum += a * b / n;
            }
        }
    }
    matrix
}

/// Eigenvalues, and eigenvectors as columns, of a symmetric matrix: Jacobi's rotations, each of
/// which clears one element off the diagonal.
fn eigen(mut matrix: Matrix) -> ([f64; TRAJECTORY_DIM], Matrix) {
    /// Convergence is quadratic: these are plenty for so small a matrix.
    const SWEEPS: usize = 20;
    let mut vectors: Matrix =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for _ in 0..SWEEPS {
        for p in 0..TRAJECTORY_DIM {
            for q in p + 1..TRAJECTORY_DIM {
                let off = matrix[p][q];
                if off == 0.0 {
                    continue;
                }
                let ratio = (matrix[q][q] - matrix[p][p]) / (2.0 * off);
                let tan = ratio.signum() / (ratio.abs() + ratio.hypot(1.0));
                let cos = 1.0 / tan.hypot(1.0);
                let sin = tan * cos;
                for row in &mut matrix {
                    rotate(row, p, q, cos, sin);
                }
                for row in &mut vectors {
                    rotate(row, p, q, cos, sin);
                }
                let (above, below) = matrix.split_at_mut(q);
                for (a, b) in above[p].iter_mut().zip(&mut below[0]) {
                    (*a, *b) = (cos * *a - sin * *b, sin * *a + cos * *b);
                }
            }
        }
    }
    (std::array::from_fn(|i| matrix[i][i]), vectors)
}

fn rotate(row: &mut [f64; TRAJECTORY_DIM], p: usize, q: usize, cos: f64, sin: f64) {
    let (a, b) = (row[p], row[q]);
    row[p] = cos * a - sin * b;
    row[q] = sin * a + cos * b;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::rng::{gaussian, random4};
    use crate::motion::features::FEATURE_DIM;

    #[test]
    fn axes_are_orthonormal_and_carry_falling_variance_without_covariance() {
        let noise = |i: u32, d: u32| gaussian(random4(7, i, d, 0));
        let rows: Vec<[f32; ROW_STRIDE]> = (0..500)
            .map(|i| {
                let common = noise(i, 99);
                std::array::from_fn(|d| noise(i, d as u32) / (d + 1) as f32 + common)
            })
            .collect();
        let axes = PrincipalAxes::of(&rows);
        for (i, a) in axes.0.iter().enumerate() {
            for (j, b) in axes.0.iter().enumerate() {
                let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-13);
            }
        }
        let projected: Vec<[f32; ROW_STRIDE]> = rows
            .iter()
            .map(|row| {
                let projected = axes.project(row);
                std::array::from_fn(|i| match i {
                    POSE_DIM..FEATURE_DIM => projected[i - POSE_DIM],
                    _ => 0.0,
                })
            })
            .collect();
        let covariance = covariance(&projected);
        for i in 0..TRAJECTORY_DIM {
            assert!(i == 0 || covariance[i][i] <= covariance[i - 1][i - 1]);
            for off in &covariance[i][..i] {
                assert!(off.abs() < 1e-6);
            }
        }
    }
}
