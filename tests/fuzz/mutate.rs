//! Inputs made of others: bytes changed, pieces moved, words and numbers exchanged.

use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};

/// Numbers that readers trip over.
const NUMBERS: [&str; 18] = [
    "0",
    "-1",
    "1",
    "2147483648",
    "4294967296",
    "18446744073709551615",
    "99999999999999999999",
    "1e300",
    "-1e300",
    "1e-300",
    "1e39",
    "nan",
    "inf",
    "-0.0",
    "0.1",
    "65536",
    "1000000",
    "3",
];

/// Makes one input after another.
pub struct Mutator<'a> {
    random: SmallRng,
    seeds: &'a [Vec<u8>],
    words: &'static [&'static str],
}

impl<'a> Mutator<'a> {
    /// The same inputs for the same seed.
    pub fn new(seed: u64, seeds: &'a [Vec<u8>], words: &'static [&'static str]) -> Self {
        Mutator {
            random: SmallRng::seed_from_u64(seed),
            seeds,
            words,
        }
    }

    /// Whether a lot of `of` falls on this.
    pub fn lot(&mut self, of: usize) -> bool {
        self.random.random_range(0..of) == 0
    }

    fn below(&mut self, end: usize) -> usize {
        self.random.random_range(0..end.max(1))
    }

    /// A part of something so long.
    fn range(&mut self, len: usize, most: usize) -> std::ops::Range<usize> {
        let start = self.below(len + 1);
        let end = (start + self.below(most + 1)).min(len);
        start..end
    }

    /// The next input.
    pub fn next(&mut self, longest: usize) -> Vec<u8> {
        let mut bytes = self.seeds[self.below(self.seeds.len())].clone();
        for _ in 0..1 + self.below(6) {
            self.change(&mut bytes);
        }
        bytes.truncate(longest);
        bytes
    }

    fn change(&mut self, bytes: &mut Vec<u8>) {
        let len = bytes.len();
        match self.below(10) {
            0 if len > 0 => bytes[self.below(len)] ^= 1 << self.below(8),
            1 if len > 0 => bytes[self.below(len)] = self.random.random(),
            2 => bytes.truncate(self.below(len + 1)),
            3 => {
                bytes.drain(self.range(len, 64));
            }
            4 => {
                let piece = bytes[self.range(len, 200)].to_vec();
                let at = self.below(len + 1);
                for _ in 0..1 + self.below(40) {
                    bytes.splice(at..at, piece.iter().copied());
                }
            }
            5 => {
                let other = &self.seeds[self.below(self.seeds.len())];
                let piece = other[self.range(other.len(), 400)].to_vec();
                let place = self.range(len, 100);
                bytes.splice(place, piece);
            }
            6 if !self.words.is_empty() => {
                let word = self.words[self.below(self.words.len())];
                let at = self.below(len + 1);
                bytes.splice(at..at, word.bytes());
            }
            7 if len > 8 => {
                // A word of a binary file.
                let at = self.below(len / 4) * 4;
                let odd = [0, 1, u32::MAX, 0x7fc0_0000, 0x7f80_0000, 0x6000_0000];
                let word = odd[self.below(odd.len())];
                bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
            }
            _ => self.exchange_number(bytes),
        }
    }

    /// Exchanges one of the numbers of a text.
    fn exchange_number(&mut self, bytes: &mut Vec<u8>) {
        let is_digit = |byte: &u8| byte.is_ascii_digit() || *byte == b'.' || *byte == b'-';
        let from = self.below(bytes.len());
        let Some(start) = bytes.iter().skip(from).position(is_digit) else {
            return;
        };
        let start = from + start;
        let end = bytes.iter().skip(start).position(|byte| !is_digit(byte));
        let end = end.map_or(bytes.len(), |length| start + length);
        let number = NUMBERS[self.below(NUMBERS.len())];
        bytes.splice(start..end, number.bytes());
    }
}
