//! Products of large matrices, by the `gemm` crate, on one core: how they are cut over cores must not
//! depend on how many there are.

use gemm::Parallelism;

/// A matrix of which element `(i, j)` is `values[i * steps[0] + j * steps[1]]`.
#[derive(Clone, Copy)]
pub struct Matrix<'a> {
    values: &'a [f32],
    shape: [usize; 2],
    steps: [usize; 2],
}

impl<'a> Matrix<'a> {
    /// Rows of `width` numbers.
    pub fn rows(values: &'a [f32], width: usize) -> Self {
        Matrix {
            values,
            shape: [values.len() / width, width],
            steps: [width, 1],
        }
    }

    /// So many columns from `first` on.
    pub fn columns(self, first: usize, count: usize) -> Self {
        Matrix {
            values: &self.values[first * self.steps[1]..],
            shape: [self.shape[0], count],
            ..self
        }
    }

    pub fn transposed(self) -> Self {
        let ([rows, columns], [row, column]) = (self.shape, self.steps);
        Matrix {
            shape: [columns, rows],
            steps: [column, row],
            ..self
        }
    }

    /// Whether the last element, and with it every other, lies within the values.
    fn is_inside(&self) -> bool {
        let last = [0, 1].map(|i| self.shape[i].wrapping_sub(1) * self.steps[i]);
        !self.shape.contains(&0) && last[0] + last[1] < self.values.len()
    }
}

/// Adds the product of `a` and `b` to `sums`, whose rows are as wide as `b`'s.
pub fn add_product(sums: &mut [f32], a: Matrix, b: Matrix) {
    let ([rows, terms], [b_rows, columns]) = (a.shape, b.shape);
    assert!(terms == b_rows && sums.len() == rows * columns);
    assert!(a.is_inside() && b.is_inside());
    let [a_row, a_column, b_row, b_column, width] =
        [a.steps[0], a.steps[1], b.steps[0], b.steps[1], columns].map(|step| step as isize);
    // SAFETY: every element of the three matrices lies within its slice, as asserted, and the sums,
    // borrowed mutably, overlap neither of the others.
    unsafe {
        gemm::gemm(
            rows,
            columns,
            terms,
            sums.as_mut_ptr(),
            1,
            width,
            true,
            a.values.as_ptr(),
            a_column,
            a_row,
            b.values.as_ptr(),
            b_column,
            b_row,
            1.0,
            1.0,
            false,
            false,
            false,
            Parallelism::None,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix of small whole numbers, so that sums are exact.
    #[test]
    fn products_are_those_of_the_definition() {
        for [rows, terms, columns] in [[1, 1, 1], [3, 2, 5], [17, 33, 9], [64, 70, 65]] {
            let some = |count: usize, by: usize| -> Vec<f32> {
                (0..count).map(|i| ((i * by) % 7) as f32 - 3.0).collect()
            };
            let (a, b) = (some(rows * terms, 5), some(columns * terms, 3));
            let mut sums = vec![1.0; rows * columns];
            add_product(
                &mut sums,
                Matrix::rows(&a, terms),
                Matrix::rows(&b, terms).transposed(),
            );
            for (at, sum) in sums.iter().enumerate() {
                let (i, j) = (at / columns, at % columns);
                let terms = (0..terms).map(|t| a[i * terms + t] * b[j * terms + t]);
                assert_eq!(*sum, 1.0 + terms.sum::<f32>());
            }
        }
    }
}
