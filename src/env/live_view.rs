//! Environments, seen from outside while they run.

use super::body_view::{BodyView, BodyWorlds};
use crate::gpu::Shared;
use crate::kernels::locomotion::locomotion_layout::{state_f32, state_u32};
use std::sync::{Arc, Mutex, PoisonError};

/// What there is to see of environments.
pub enum LiveView {
    /// Characters that recorded frames are played of.
    Locomotion(LocomotionView),
    /// Simulated bodies.
    Bodies(BodyView),
}

/// Where environments keep what there is to see of motion matching.
pub enum LocomotionView {
    /// The GPU's own buffers: whoever draws on that device reads them in place.
    Gpu(Box<Buffers>),
    /// The latest step's state of environments on the CPU.
    Cpu(States),
}

/// State of a batch in the buffers that its kernels work on.
pub struct Buffers {
    /// `[state_f32::FIELDS][envs]`, see [`crate::kernels::locomotion::locomotion_layout`].
    pub state_f32: Shared,
    /// `[state_u32::FIELDS][envs]`
    pub state_u32: Shared,
    /// `[envs][boxes::FIELDS][count]`, where there are obstacles.
    pub boxes: Option<Shared>,
}

/// On the host: the parts of a batch, whose steps need not be the same.
#[derive(Clone)]
pub struct States(pub Vec<Arc<Mutex<State>>>);

/// The state of one part on the host.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// `[state_f32::FIELDS][envs]`
    pub state_f32: Vec<f32>,
    /// `[state_u32::FIELDS][envs]`
    pub state_u32: Vec<u32>,
    /// `[envs][boxes::FIELDS][count]`; empty without obstacles.
    pub boxes: Vec<f32>,
}

/// `[count][environments of all parts][..]` from `[count][environments of a part][..]`.
fn fields<P, T: Copy>(count: usize, parts: &[P], values: impl Fn(&P) -> &[T]) -> Vec<T> {
    let of_part = |field: usize, part: &P| {
        let values = values(part);
        let length = values.len() / count;
        values[field * length..][..length].to_vec()
    };
    let order = (0..count).flat_map(|field| parts.iter().map(move |part| (field, part)));
    order
        .flat_map(|(field, part)| of_part(field, part))
        .collect()
}

impl State {
    /// Takes what a step has left.
    pub fn set(&mut self, state_f32: &[f32], state_u32: &[u32], boxes: &[f32]) {
        self.state_f32.clear();
        self.state_f32.extend_from_slice(state_f32);
        self.state_u32.clear();
        self.state_u32.extend_from_slice(state_u32);
        self.boxes.clear();
        self.boxes.extend_from_slice(boxes);
    }
}

impl States {
    /// The state of all parts together.
    pub fn now(&self) -> State {
        let locked = |part: &Arc<Mutex<State>>| {
            let state = part.lock().unwrap_or_else(PoisonError::into_inner);
            state.clone()
        };
        let parts: Vec<State> = self.0.iter().map(locked).collect();
        State {
            state_f32: fields(state_f32::FIELDS, &parts, |part| &part.state_f32),
            state_u32: fields(state_u32::FIELDS, &parts, |part| &part.state_u32),
            boxes: fields(1, &parts, |part| &part.boxes),
        }
    }
}

impl LiveView {
    /// That of motion matching.
    pub fn locomotion(self) -> Option<LocomotionView> {
        match self {
            LiveView::Locomotion(view) => Some(view),
            LiveView::Bodies(_) => None,
        }
    }

    /// Adds the view of another part of the same batch. Parts on a GPU are alone.
    pub fn join(&mut self, other: LiveView) {
        match (self, other) {
            (
                LiveView::Locomotion(LocomotionView::Cpu(States(all))),
                LiveView::Locomotion(LocomotionView::Cpu(States(more))),
            ) => all.extend(more),
            (LiveView::Bodies(all), LiveView::Bodies(more)) => {
                if let (BodyWorlds::Cpu(all), BodyWorlds::Cpu(more)) =
                    (&mut all.worlds, more.worlds)
                {
                    all.extend(more);
                }
            }
            _ => {}
        }
    }
}
