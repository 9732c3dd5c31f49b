//! Golden files: what `tests/reference` had MuJoCo compute.

use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};

/// Beside the scripts that made them, or where FOOTWORK_GOLDEN says that they were made anew.
fn path(name: &str) -> PathBuf {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference");
    std::env::var_os("FOOTWORK_GOLDEN")
        .map_or(beside, PathBuf::from)
        .join(name)
}

fn read(name: &str) -> Vec<u8> {
    let path = path(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

pub fn json<T: DeserializeOwned>(name: &str) -> T {
    serde_json::from_slice(&read(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Rows of single-precision numbers.
pub struct Golden {
    numbers: Vec<f32>,
    width: usize,
}

/// A row of a golden file, read from left to right.
pub struct Row<'a>(&'a [f32]);

impl Golden {
    pub fn open(name: &str, width: usize) -> Golden {
        let bytes = read(name);
        let words = bytes.chunks_exact(4);
        let numbers: Vec<f32> = words
            .map(|w| f32::from_le_bytes(w.try_into().unwrap()))
            .collect();
        assert_eq!(
            numbers.len() % width,
            0,
            "{name}: rows are not {width} numbers wide"
        );
        Golden { numbers, width }
    }

    pub fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.numbers.chunks_exact(self.width).map(Row)
    }
}

impl<'a> Row<'a> {
    pub fn take(&mut self, count: usize) -> &'a [f32] {
        let (taken, rest) = self.0.split_at(count);
        self.0 = rest;
        taken
    }
}

/// Largest difference, as a part of the largest number wanted.
pub fn relative(found: &[f32], wanted: &[f32]) -> f32 {
    let most = |values: &mut dyn Iterator<Item = f32>| values.fold(0.0, f32::max);
    let off = most(&mut found.iter().zip(wanted).map(|(a, b)| (a - b).abs()));
    let size = most(&mut wanted.iter().map(|w| w.abs()));
    off / size.max(f32::MIN_POSITIVE)
}

/// The value that a part of the values lies below.
pub fn quantile(values: &[f32], part: f64) -> f32 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted[((sorted.len() - 1) as f64 * part).round() as usize]
}
