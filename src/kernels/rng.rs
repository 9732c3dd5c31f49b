//! Counter-based random numbers keyed by (seed, environment, clock, stream): the twin of
//! `shaders/shared/rng.wgsl`, equal bit for bit. Nothing is stored, so a resumed run draws what
//! the uninterrupted one would have drawn.

const MULTIPLIER: u32 = 1664525;
const INCREMENT: u32 = 1013904223;

/// 128 random bits: pcg4d of Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT
/// 9(3), 2020.
#[inline]
pub fn random4(seed: u32, environment: u32, clock: u32, stream: u32) -> [u32; 4] {
    let [mut x, mut y, mut z, mut w] = [seed, environment, clock, stream]
        .map(|v| v.wrapping_mul(MULTIPLIER).wrapping_add(INCREMENT));
    let mut round = || {
        x = x.wrapping_add(y.wrapping_mul(w));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        w = w.wrapping_add(y.wrapping_mul(z));
        [x, y, z, w] = [x, y, z, w].map(|v| v ^ (v >> 16));
    };
    round();
    x = x.wrapping_add(y.wrapping_mul(w));
    y = y.wrapping_add(z.wrapping_mul(x));
    z = z.wrapping_add(x.wrapping_mul(y));
    w = w.wrapping_add(y.wrapping_mul(z));
    [x, y, z, w]
}

/// `[0, 1)` in steps of 2^-24: exact in f32.
#[inline]
pub fn uniform01(bits: u32) -> f32 {
    (bits >> 8) as f32 * 5.9604645e-8
}

/// `0 .. below`, by the high word of a product.
#[inline]
pub fn index_below(bits: u32, below: u32) -> u32 {
    ((u64::from(bits) * u64::from(below)) >> 32) as u32
}

/// Standard normal from 128 random bits: the binomial count of 96 of them, smoothed by a uniform
/// step from the other 32. Integers up to one exact conversion and one multiplication, so every
/// device draws the same number. Excess kurtosis -0.02; reaches 9.8 deviations.
#[inline]
pub fn gaussian(bits: [u32; 4]) -> f32 {
    let count = (bits[0].count_ones() + bits[1].count_ones() + bits[2].count_ones()) as i32 - 48;
    let fine = (count << 16) + (bits[3] >> 16) as i32 - 32768;
    fine as f32 * 3.109294e-6 // 2^-16 / sqrt(24 + 1/12)
}

/// A permutation of `0..len`, Fisher and Yates' shuffle.
pub fn permutation(seed: u32, clock: u32, stream: u32, len: usize) -> Vec<u32> {
    let mut order: Vec<u32> = (0..len as u32).collect();
    for i in (1..len).rev() {
        let [bits, ..] = random4(seed, i as u32, clock, stream);
        order.swap(i, index_below(bits, i as u32 + 1) as usize);
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaussians_have_the_moments_of_a_normal_distribution() {
        let n = 1_000_000;
        let draws: Vec<f64> = (0..n)
            .map(|i| f64::from(gaussian(random4(7, i, 3, 1))))
            .collect();
        let moment = |k: i32| draws.iter().map(|d| d.powi(k)).sum::<f64>() / f64::from(n);
        assert!(moment(1).abs() < 4e-3, "mean {}", moment(1));
        assert!((moment(2) - 1.0).abs() < 6e-3, "variance {}", moment(2));
        assert!(moment(3).abs() < 2e-2, "skewness {}", moment(3));
        assert!((moment(4) - 3.0).abs() < 6e-2, "kurtosis {}", moment(4));
    }

    #[test]
    fn neighbouring_keys_are_independent() {
        let n = 200_000u32;
        let draw = |a, b, c| f64::from(gaussian(random4(1, a, b, c)));
        for (da, db, dc) in [(1, 0, 0), (0, 1, 0), (0, 0, 1)] {
            let together: f64 = (0..n)
                .map(|i| draw(i, 5, 9) * draw(i + da, 5 + db, 9 + dc))
                .sum();
            assert!((together / f64::from(n)).abs() < 0.01);
        }
    }

    #[test]
    fn permutations_hold_every_place_once_and_differ() {
        let mut order = permutation(1, 2, 3, 1000);
        assert_ne!(order, permutation(1, 3, 3, 1000));
        order.sort_unstable();
        assert!(order.iter().enumerate().all(|(i, &o)| i as u32 == o));
    }
}
