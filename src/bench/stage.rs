//! What the stages after the search share.

use super::bench_device::BenchDevice;
use super::plan::BenchPlan;
use super::roofline::Roofline;
use crate::matching::MotionMatcher;
use std::sync::Arc;

/// A device, and what is measured on it.
pub struct BenchContext<'a> {
    pub plan: &'a BenchPlan<'a>,
    pub on: &'a BenchDevice,
    pub roofline: &'a Roofline,
    pub matcher: &'a Arc<MotionMatcher>,
}

/// Environments of a batch.
pub const ENVS: [usize; 5] = [256, 1024, 4096, 16_384, 65_536];
