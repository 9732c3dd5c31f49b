//! How much an engine evaluates and learns from.

use super::network::Network;
use crate::gpu::Array;
use std::ops::Range;

/// Which of the samples make up a minibatch.
#[derive(Clone, Debug)]
pub enum Rows<'a> {
    /// Those of a range.
    Range(Range<usize>),
    /// Those of a list; on the CPU only.
    Indices(&'a [u32]),
}

/// Samples `[..][width]` that begin with observations: `count` of them from `first` on.
#[derive(Clone, Copy)]
pub(super) struct Samples<'a> {
    pub values: &'a Array,
    pub width: usize,
    pub first: usize,
    pub count: usize,
}

/// What [`Engine::new`](super::engine::Engine::new) is told of what there is to evaluate and to learn.
#[derive(Clone, Copy, Debug)]
pub struct EngineSize {
    /// Length of the flat vector.
    pub parameters: usize,
    /// Numbers that the objective adds up.
    pub extras: usize,
    /// The most rows evaluated at once.
    pub max_rows: usize,
    /// The most rows learned from at once.
    pub minibatch: usize,
}

impl EngineSize {
    /// Parameters behind those of the networks.
    pub(super) fn others(&self, networks: &[Network]) -> usize {
        self.parameters - networks.last().map_or(0, |last| last.span().end)
    }
}
