//! The performer's random numbers: a named generator and integer arithmetic, so that a seed means
//! the same motion everywhere.

use rand::rngs::Xoshiro256PlusPlus;
use rand::{Rng, SeedableRng};

pub struct Random(Xoshiro256PlusPlus);

impl Random {
    /// A stream of its own for every (seed, stream) pair.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut bytes = [0; 32];
        bytes[..8].copy_from_slice(&seed.to_le_bytes());
        bytes[8..16].copy_from_slice(&stream.to_le_bytes());
        let mut generator = Xoshiro256PlusPlus::from_seed(bytes);
        // Nearly equal states take a few draws to part.
        for _ in 0..32 {
            generator.next_u64();
        }
        Random(generator)
    }

    /// Uniform in `low..high`.
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        let unit = (self.0.next_u64() >> 40) as f32 / (1u64 << 24) as f32;
        low + (high - low) * unit
    }

    pub fn chance(&mut self, probability: f32) -> bool {
        self.range(0.0, 1.0) < probability
    }

    /// -1 or 1.
    pub fn sign(&mut self) -> f32 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }
}
