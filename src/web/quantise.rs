//! Numbers in 16 bits.

use glam::Quat;

/// Largest code.
const MAX_CODE: f32 = u16::MAX as f32;
/// Largest code of a part of a quaternion, of 15 bits.
const MAX_PART: f32 = 32767.0;

/// Rows of numbers, 16 bits each: every column has its own range.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantisedColumns {
    /// Least number of each column.
    pub low: Vec<f32>,
    /// Difference between two codes of each column.
    pub step: Vec<f32>,
    /// `[rows][columns]`
    pub codes: Vec<u16>,
}

impl QuantisedColumns {
    /// Of `values`, `[rows][columns]`, which are finite.
    pub fn of(values: &[f32], columns: usize) -> QuantisedColumns {
        let (mut low, mut high) = (
            vec![f32::INFINITY; columns],
            vec![f32::NEG_INFINITY; columns],
        );
        for row in values.chunks_exact(columns) {
            for (column, &value) in row.iter().enumerate() {
                low[column] = low[column].min(value);
                high[column] = high[column].max(value);
            }
        }
        let steps = low.iter().zip(&high);
        let step: Vec<f32> = steps.map(|(low, high)| (high - low) / MAX_CODE).collect();
        let code = |(at, &value): (usize, &f32)| {
            let column = at % columns;
            let code = (value - low[column]) / step[column].max(f32::MIN_POSITIVE);
            code.round().clamp(0.0, MAX_CODE) as u16
        };
        QuantisedColumns {
            codes: values.iter().enumerate().map(code).collect(),
            low,
            step,
        }
    }

    /// The numbers, `[rows][columns]`, each off by half a step at most.
    pub fn values(&self) -> Vec<f32> {
        let columns = self.low.len();
        let value = |(at, &code): (usize, &u16)| {
            self.low[at % columns] + self.step[at % columns] * f32::from(code)
        };
        self.codes.iter().enumerate().map(value).collect()
    }
}

/// A rotation in 48 bits: the number of the quaternion's largest part, which follows from the others, and those in 15
/// bits each.
pub fn quantise_rotation(rotation: Quat) -> [u16; 3] {
    let parts = rotation.normalize().to_array();
    let largest = (0..4).fold(0, |best, at| match parts[at].abs() > parts[best].abs() {
        true => at,
        false => best,
    });
    // A quaternion and its opposite are one rotation.
    let sign = parts[largest].signum();
    let code = |at: usize| {
        let part = sign * parts[at] * std::f32::consts::SQRT_2;
        ((0.5 + 0.5 * part) * MAX_PART).round().clamp(0.0, MAX_PART) as u16
    };
    let [a, b, c] = others(largest).map(code);
    let bit = |number: usize| ((largest >> number & 1) as u16) << 15;
    [a | bit(0), b | bit(1), c]
}

/// The rotation of a code, off by a hundredth of a degree at most.
pub fn rotation([a, b, c]: [u16; 3]) -> Quat {
    let largest = usize::from(a >> 15) | usize::from(b >> 15) << 1;
    let mut parts = [0.0; 4];
    let mut squares = 0.0;
    for (at, code) in others(largest).into_iter().zip([a, b, c]) {
        let part = f32::from(code & 0x7fff) / MAX_PART;
        parts[at] = (2.0 * part - 1.0) * std::f32::consts::FRAC_1_SQRT_2;
        squares += parts[at] * parts[at];
    }
    parts[largest] = (1.0 - squares).max(0.0).sqrt();
    Quat::from_array(parts).normalize()
}

/// The numbers of the other three parts of a quaternion.
fn others(largest: usize) -> [usize; 3] {
    [1, 2, 3].map(|ahead| (largest + ahead) % 4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_off_by_half_a_step() {
        let values = [1.0, -3.0, 5.0, -3.0, 2.25, -3.0];
        let quantised = QuantisedColumns::of(&values, 2);
        for (value, near) in values.iter().zip(quantised.values()) {
            assert!((value - near).abs() <= 0.5 * 4.0 / MAX_CODE + 1e-6);
        }
        assert_eq!(quantised.values()[1], -3.0, "a column of one number");
    }

    #[test]
    fn rotations_are_off_by_a_hundredth_of_a_degree() {
        for number in 0..2000 {
            let angle = |step: f32| step * number as f32;
            let turn = Quat::from_euler(glam::EulerRot::XYZ, angle(0.37), angle(0.11), angle(0.73));
            // By its sine: the cosine of so small an angle is 1 in 32 bits.
            let away = rotation(quantise_rotation(turn)) * turn.inverse();
            let off = (2.0 * away.xyz().length().asin()).to_degrees();
            assert!(off < 0.01, "{turn}: {off} degrees");
        }
        let half = Quat::from_xyzw(0.0, 1.0, 0.0, 0.0);
        assert!(rotation(quantise_rotation(-half)).dot(half).abs() > 0.999_999);
    }
}
