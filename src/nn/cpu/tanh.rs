//! The hyperbolic tangent, many at a time.

use crate::kernels::fma::mul_add;
use multiversion::multiversion;

/// Beyond this it is 1 in f32.
const FLAT: f32 = 9.1;

/// Hyperbolic tangent of every value, within 3e-7.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
pub fn tanh(values: &mut [f32]) {
    for value in values {
        // tanh x = 1 - 2 / (exp 2x + 1), and exp y = 2^whole exp(rest) with |rest| < 0.35, where
        // seven terms of the series are enough. NaN passes through.
        let y = 2.0 * value.clamp(-FLAT, FLAT);
        let whole = (y * std::f32::consts::LOG2_E).round_ties_even();
        let rest = mul_add(-whole, std::f32::consts::LN_2, y);
        const TERMS: [f32; 7] = [
            1.0 / 720.0,
            1.0 / 120.0,
            1.0 / 24.0,
            1.0 / 6.0,
            0.5,
            1.0,
            1.0,
        ];
        let series = TERMS
            .iter()
            .fold(1.0 / 5040.0, |sum: f32, term| mul_add(sum, rest, *term));
        // At most 27 either way: the exponent has room.
        let power = f32::from_bits(((whole as i32 + 127) as u32) << 23);
        *value = 1.0 - 2.0 / mul_add(series, power, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_near_the_standard_library_s() {
        let inputs: Vec<f32> = (-40_000..=40_000).map(|i| i as f32 / 2500.0).collect();
        let mut outputs = inputs.clone();
        tanh(&mut outputs);
        for (x, y) in inputs.iter().zip(&outputs) {
            let wanted = f64::from(*x).tanh();
            assert!((f64::from(*y) - wanted).abs() < 3e-7, "{x}: {y}");
        }
        let mut ends = [f32::INFINITY, f32::NEG_INFINITY, 0.0, f32::NAN];
        tanh(&mut ends);
        assert_eq!(ends[..3], [1.0, -1.0, 0.0]);
        assert!(ends[3].is_nan());
    }
}
