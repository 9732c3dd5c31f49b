//! Savitzky-Golay smoothing (Savitzky and Golay 1964): a cubic fitted to a sliding window.

/// Frames of the window: half a second at 30 Hz.
pub const WINDOW: usize = 15;
const HALF: isize = (WINDOW / 2) as isize;
const DEGREE: usize = 3;

/// Smooths `values`, one a frame. Near the ends the cubic of the first or last whole window is
/// read where it is needed, so nothing is made up beyond the recording.
///
/// # Panics
/// With fewer than [`WINDOW`] values; import leaves such clips out.
pub fn savitzky_golay(values: &[f32]) -> Vec<f32> {
    assert!(
        values.len() >= WINDOW,
        "a clip shorter than the smoothing window"
    );
    let weights: Vec<[f64; WINDOW]> = (-HALF..=HALF).map(weights_at).collect();
    let last = values.len() - WINDOW;
    (0..values.len())
        .map(|frame| {
            let start = frame.saturating_sub(HALF as usize).min(last);
            let row = &weights[frame - start];
            let window = &values[start..start + WINDOW];
            row.iter()
                .zip(window)
                .map(|(w, v)| w * f64::from(*v))
                .sum::<f64>() as f32
        })
        .collect()
}

/// Weights whose sum over the window is the fitted cubic at `offset` frames from its middle.
fn weights_at(offset: isize) -> [f64; WINDOW] {
    let mut normal = [[0.0; DEGREE + 2]; DEGREE + 1];
    for at in -HALF..=HALF {
        let powers = powers(at);
        for (row, p) in normal.iter_mut().zip(powers) {
            for (cell, q) in row.iter_mut().zip(powers) {
                *cell += p * q;
            }
        }
    }
    for (row, p) in normal.iter_mut().zip(powers(offset)) {
        row[DEGREE + 1] = p;
    }
    let coefficients = solve(normal);
    let mut weights = [0.0; WINDOW];
    for (weight, at) in weights.iter_mut().zip(-HALF..=HALF) {
        *weight = powers(at)
            .iter()
            .zip(coefficients)
            .map(|(p, c)| p * c)
            .sum();
    }
    weights
}

/// `at^0 ..= at^DEGREE`, with `at` scaled to [-1, 1] for a well-conditioned fit.
fn powers(at: isize) -> [f64; DEGREE + 1] {
    let x = at as f64 / HALF as f64;
    [1.0, x, x * x, x * x * x]
}

/// Gauss-Jordan on a small positive definite system; the last column is the right-hand side.
fn solve(mut m: [[f64; DEGREE + 2]; DEGREE + 1]) -> [f64; DEGREE + 1] {
    for i in 0..=DEGREE {
        let pivot = m[i];
        let pivot = pivot.map(|cell| cell / pivot[i]);
        m[i] = pivot;
        for (j, row) in m.iter_mut().enumerate() {
            if j != i {
                let factor = row[i];
                for (cell, p) in row.iter_mut().zip(pivot) {
                    *cell -= factor * p;
                }
            }
        }
    }
    m.map(|row| row[DEGREE + 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_passes_unchanged_to_its_very_ends() {
        let cubic: Vec<f32> = (0..40)
            .map(|i| i as f32 * 0.1)
            .map(|x| 1.0 - 2.0 * x + 0.5 * x * x - 0.1 * x * x * x)
            .collect();
        for (smooth, exact) in savitzky_golay(&cubic).iter().zip(&cubic) {
            assert!((smooth - exact).abs() < 1e-4, "{smooth} {exact}");
        }
    }

    #[test]
    fn middle_weights_are_the_published_ones() {
        // Savitzky and Golay 1964, table I, 15 points, quadratic-cubic: /1105.
        let published = [-78.0, -13.0, 42.0, 87.0, 122.0, 147.0, 162.0, 167.0];
        for (weight, published) in weights_at(0).iter().zip(published) {
            assert!((weight - published / 1105.0).abs() < 1e-12);
        }
    }

    #[test]
    fn noise_shrinks() {
        let noise: Vec<f32> = (0..400)
            .map(|i: u32| (i.wrapping_mul(2654435761) >> 16) as f32 / 65536.0 - 0.5)
            .collect();
        let power = |v: &[f32]| v.iter().map(|x| x * x).sum::<f32>();
        assert!(power(&savitzky_golay(&noise)) < 0.3 * power(&noise));
    }
}
