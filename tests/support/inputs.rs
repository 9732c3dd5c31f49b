//! Random and poisoned inputs, and comparisons.

use footwork::gpu::Gpu;
use footwork::kernels::locomotion::locomotion_layout::{state_f32, state_u32};
use footwork::kernels::rng::{gaussian, index_below, random4, uniform01};
use footwork::motion::database::RootMotion;
use footwork::motion::features::{FEATURE_DIM, ROW_STRIDE};
use std::ops::Range;

/// What outputs hold before a kernel runs: what it leaves unwritten, or writes where it must not,
/// shows.
pub const POISON: f32 = -12345.0;
pub const POISON_WHOLE: u32 = POISON.to_bits();

/// Batch sizes around the workgroup's 64 invocations.
pub const SIZES: [usize; 5] = [1, 63, 64, 65, 1000];
pub const SEEDS: [u32; 3] = [0, 7, u32::MAX];

/// The software adapter, as the program opens it.
pub fn gpu() -> Gpu {
    Gpu::lavapipe().unwrap_or_else(|error| panic!("{error}"))
}

/// A stream of random numbers.
pub struct Draw {
    seed: u32,
    count: u32,
}

impl Draw {
    pub fn new(seed: u32) -> Self {
        Draw { seed, count: 0 }
    }

    pub fn bits(&mut self) -> [u32; 4] {
        self.count += 1;
        random4(self.seed, self.count, 0x7465, 0x7374)
    }

    pub fn below(&mut self, end: usize) -> usize {
        index_below(self.bits()[0], end as u32) as usize
    }

    pub fn within(&mut self, half: f32) -> f32 {
        (2.0 * uniform01(self.bits()[0]) - 1.0) * half
    }

    pub fn normal(&mut self) -> f32 {
        gaussian(self.bits())
    }

    pub fn unit(&mut self) -> [f32; 2] {
        let (sin, cos) = f64::from(self.within(std::f32::consts::PI)).sin_cos();
        [sin as f32, cos as f32]
    }

    pub fn normals(&mut self, count: usize) -> Vec<f32> {
        (0..count).map(|_| self.normal()).collect()
    }

    /// A feature row; its last number is `last`.
    pub fn row(&mut self, last: f32) -> [f32; ROW_STRIDE] {
        std::array::from_fn(|i| if i < FEATURE_DIM { self.normal() } else { last })
    }

    pub fn rows(&mut self, count: usize, last: f32) -> Vec<[f32; ROW_STRIDE]> {
        (0..count).map(|_| self.row(last)).collect()
    }

    pub fn motion(&mut self) -> RootMotion {
        RootMotion {
            moved: [self.within(1.0), self.within(1.0)],
            turned: self.unit(),
            length: self.within(1.0).abs(),
        }
    }

    /// A plausible state of `envs` environments that show one of `frames` frames.
    pub fn state(&mut self, envs: usize, frames: usize) -> (Vec<f32>, Vec<u32>) {
        let (mut reals, mut wholes) = (
            vec![0.0; state_f32::FIELDS * envs],
            vec![0; state_u32::FIELDS * envs],
        );
        for env in 0..envs {
            let heading = self.unit();
            for field in 0..state_f32::FIELDS {
                reals[field * envs + env] = match field {
                    state_f32::HEADING_X => heading[0],
                    state_f32::HEADING_Z => heading[1],
                    _ => self.within(20.0),
                };
            }
            let below = [frames, 250, 250, 4, 2, 9, 3, 3, 3, 900];
            for (field, below) in below.into_iter().enumerate() {
                wholes[field * envs + env] = self.below(below) as u32;
            }
        }
        (reals, wholes)
    }
}

/// Equal bit for bit; any NaN equals any other.
#[track_caller]
pub fn same(what: &str, got: &[f32], want: &[f32]) {
    assert_eq!(got.len(), want.len(), "{what}: lengths");
    for (i, (g, w)) in got.iter().zip(want).enumerate() {
        let equal = g.to_bits() == w.to_bits() || g.is_nan() && w.is_nan();
        assert!(equal, "{what}[{i}]: {g:e} instead of {w:e}");
    }
}

/// Within `bar(i)` of each other; equal infinities and any two NaNs are.
#[track_caller]
pub fn close(what: &str, got: &[f32], want: &[f32], bar: impl Fn(usize) -> f32) {
    assert_eq!(got.len(), want.len(), "{what}: lengths");
    for (i, (&g, &w)) in got.iter().zip(want).enumerate() {
        let fits = g == w || g.is_nan() && w.is_nan() || (g - w).abs() <= bar(i);
        assert!(fits, "{what}[{i}]: {g:e} instead of {w:e} +- {:e}", bar(i));
    }
}

/// Four roundings of the largest term of a sum: what fusing products into sums may change.
pub fn within_terms(terms: &[f32]) -> f32 {
    terms.iter().fold(0.0f32, |most, term| most.max(term.abs())) * 4.0 * f32::EPSILON
}

/// Everything outside `written`.
pub fn places_but<'a, T>(
    written: &'a Range<usize>,
    values: &'a [T],
) -> impl Iterator<Item = &'a T> {
    values[..written.start].iter().chain(&values[written.end..])
}
