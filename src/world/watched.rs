//! Worlds, seen from outside while they run.

use super::snapshot::fields;
use crate::gpu::Shared;
use crate::kernels::layout::{real, whole};
use std::sync::{Arc, Mutex, PoisonError};

/// Where worlds keep what there is to see.
pub enum Watched {
    /// The GPU's own buffers: whoever draws on that device reads them in place.
    Gpu(Box<Buffers>),
    /// The latest step's state of worlds on the CPU.
    Cpu(States),
}

pub struct Buffers {
    /// `[real::FIELDS][envs]`, see [`crate::kernels::layout`].
    pub real: Shared,
    /// `[whole::FIELDS][envs]`
    pub whole: Shared,
    /// `[envs][boxes::FIELDS][count]`, where there are obstacles.
    pub boxes: Option<Shared>,
}

/// On the host: the parts of a batch, whose steps need not be the same.
#[derive(Clone)]
pub struct States(pub Vec<Arc<Mutex<State>>>);

/// The same of one part.
#[derive(Clone, Debug, Default)]
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

impl States {
    /// Of all parts together.
    pub fn now(&self) -> State {
        let locked = |part: &Arc<Mutex<State>>| {
            let state = part.lock().unwrap_or_else(PoisonError::into_inner);
            state.clone()
        };
        let parts: Vec<State> = self.0.iter().map(locked).collect();
        State {
            real: fields(real::FIELDS, &parts, |part| &part.real),
            whole: fields(whole::FIELDS, &parts, |part| &part.whole),
            boxes: fields(1, &parts, |part| &part.boxes),
        }
    }
}
