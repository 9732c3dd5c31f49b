//! Simulated bodies, seen from outside while they run.

use crate::gpu::Shared;
use crate::physics::model::Model;
use std::sync::{Arc, Mutex, PoisonError};

/// Simulated bodies, and where environments keep what there is to see of them.
pub struct BodyView {
    /// What every world simulates.
    pub model: Arc<Model>,
    /// The worlds.
    pub worlds: BodyWorlds,
}

/// Where the worlds of a batch are.
pub enum BodyWorlds {
    /// In the GPU's own buffers.
    Gpu(Box<BodyBuffers>),
    /// On the host: the latest step of each part of a batch.
    Cpu(Vec<Arc<Mutex<BodyStates>>>),
}

/// Worlds in the buffers that their kernels work on.
pub struct BodyBuffers {
    /// Number of worlds.
    pub envs: usize,
    /// `[bodies * POSE_DIM][envs]`, see [`crate::kernels::physics::smooth_dynamics`].
    pub poses: Shared,
    /// Positions and velocities in which the episodes began, `[nq + nv][envs]`.
    pub starts: Shared,
}

/// Worlds on the host.
#[derive(Clone, Debug, Default)]
pub struct BodyStates {
    /// Positions, `[envs][nq]`.
    pub q: Vec<f32>,
    /// Points of the ground where the episodes began, `[envs]`, m.
    pub starts: Vec<[f32; 2]>,
}

impl BodyStates {
    /// Takes what a step has left: the positions of each world, and those in which its episode began.
    pub fn set<'a>(&mut self, worlds: impl Iterator<Item = (&'a [f32], &'a [f32])>) {
        self.q.clear();
        self.starts.clear();
        for (q, start) in worlds {
            self.q.extend_from_slice(q);
            self.starts.push([start[0], start[1]]);
        }
    }

    /// The worlds of all parts together.
    pub fn joined(parts: &[Arc<Mutex<BodyStates>>]) -> BodyStates {
        let mut all = BodyStates::default();
        for part in parts {
            let part = part.lock().unwrap_or_else(PoisonError::into_inner);
            all.q.extend_from_slice(&part.q);
            all.starts.extend_from_slice(&part.starts);
        }
        all
    }
}
