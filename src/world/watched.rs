//! A batch of worlds, seen from outside while it runs.

use crate::gpu::Shared;
use std::sync::{Arc, Mutex};

/// Where a batch keeps what there is to see.
pub enum Watched {
    /// The GPU's own buffers: whoever draws on that device reads them in place.
    Gpu(Box<Buffers>),
    /// The latest step's state of a batch on the CPU.
    Cpu(Arc<Mutex<State>>),
}

pub struct Buffers {
    /// `[real::FIELDS][envs]`, see [`crate::kernels::layout`].
    pub real: Shared,
    /// `[whole::FIELDS][envs]`
    pub whole: Shared,
    /// `[envs][boxes::FIELDS][count]`, where there are obstacles.
    pub boxes: Option<Shared>,
}

/// The same, on the host.
#[derive(Debug, Default)]
pub struct State {
    pub real: Vec<f32>,
    pub whole: Vec<u32>,
    pub boxes: Vec<f32>,
}

impl State {
    /// Takes what a step has left.
    pub fn set(&mut self, real: &[f32], whole: &[u32], boxes: &[f32]) {
        self.real.clear();
        self.real.extend_from_slice(real);
        self.whole.clear();
        self.whole.extend_from_slice(whole);
        self.boxes.clear();
        self.boxes.extend_from_slice(boxes);
    }
}
