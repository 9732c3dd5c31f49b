//! What a network sees.

use serde::{Deserialize, Serialize};

/// An observation of one agent: a vector, and maps beside it where there are any.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ObservationSpec {
    /// Numbers of the vector; they come first.
    pub vector: usize,
    /// `[height, width, channels]` of the maps that follow it, channels last.
    pub grid: Option<[usize; 3]>,
}

impl ObservationSpec {
    /// Numbers of an observation, the maps included.
    pub fn dim(&self) -> usize {
        self.vector + self.grid.map_or(0, |shape| shape.iter().product())
    }
}
