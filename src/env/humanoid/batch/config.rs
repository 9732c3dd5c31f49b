//! A batch to be opened, and the parameters of its kernels.

use crate::gpu::Device;
use crate::kernels::physics::{make_constraints, random_targets, reset_worlds};
use crate::physics::model::Model;
use crate::physics::simulator::SolverOptions;
use anyhow::Result;
use std::sync::Arc;

/// A world with a velocity over this, m/s or rad/s, has diverged.
pub const MAX_SPEED: f32 = 1e3;

/// A batch to be opened.
#[derive(Clone, Debug)]
pub struct SimulatorBatchConfig {
    /// Model that every world simulates.
    pub model: Arc<Model>,
    /// Number of worlds.
    pub envs: usize,
    /// Time step and constraint solver.
    pub options: SolverOptions,
    /// Seed of all random numbers drawn for these worlds.
    pub seed: u32,
    /// Pairs of bodies whose forces on each other are wanted.
    pub force_pairs: Vec<[usize; 2]>,
}

/// Stream of the random targets.
const STREAM: u32 = 0x5449_4d45;

impl SimulatorBatchConfig {
    /// Positions and velocities of all worlds at the model's start, `[nq + nv][envs]`.
    pub fn starts(&self) -> Vec<f32> {
        let values = self.model.qpos0.iter().copied();
        let still = std::iter::repeat_n(0.0, self.model.nv());
        let values = values.chain(still);
        values
            .flat_map(|value| std::iter::repeat_n(value, self.envs))
            .collect()
    }

    /// Whether a device has room for so many worlds.
    ///
    /// # Errors
    /// It has not.
    pub fn check(&self, device: &Device) -> Result<()> {
        let rows = make_constraints::rows(&self.model, self.options.max_contacts);
        let quads = self.model.dofs.len().div_ceil(4);
        let numbers = 4 * quads * rows * self.envs;
        device
            .holds("constraints of all environments", numbers)
            .map_err(|error| anyhow::anyhow!("{error}: use fewer environments"))
    }

    /// Asserts that `targets` holds a target for every drive, `[nu][envs]`.
    ///
    /// # Panics
    /// It has another length.
    pub fn check_targets(&self, targets: &[f32]) {
        let wanted = self.model.nu() * self.envs;
        assert_eq!(targets.len(), wanted, "targets of all drives");
    }

    /// Asserts that `forces` holds a torque and a force for every body, `[bodies * 6][envs]`.
    ///
    /// # Panics
    /// It has another length.
    pub fn check_external_forces(&self, forces: &[f32]) {
        let wanted = 6 * self.model.bodies.len() * self.envs;
        assert_eq!(forces.len(), wanted, "forces on all bodies");
    }

    /// Asserts that `mask` is `[envs]` and `starts` is `[nq + nv][envs]`.
    ///
    /// # Panics
    /// One of them has another length.
    pub fn check_starts(&self, mask: &[u32], starts: &[f32]) {
        assert_eq!(mask.len(), self.envs, "a mask of all worlds");
        let wanted = (self.model.nq() + self.model.nv()) * self.envs;
        assert_eq!(starts.len(), wanted, "starts of all worlds");
    }

    /// Parameters of the kernel `random_targets`: targets of the standard deviation `std`, rad, after
    /// `step_counter` actions.
    pub fn random_targets(&self, std: f32, step_counter: u32) -> random_targets::Params {
        random_targets::Params {
            envs: self.envs as u32,
            driven: self.model.nu() as u32,
            action_std: std,
            seed: self.seed,
            step_counter,
            stream: STREAM,
        }
    }

    /// Parameters of the kernel `reset_worlds`.
    pub fn reset_worlds(&self) -> reset_worlds::Params {
        reset_worlds::Params {
            envs: self.envs as u32,
            max_contacts: self.options.max_contacts as u32,
            max_speed: MAX_SPEED,
        }
    }

    /// The number of pairs of bodies whose forces are wanted, then the pairs.
    pub fn force_pairs(&self) -> Vec<u32> {
        let pairs = self.force_pairs.as_flattened().iter();
        let count = self.force_pairs.len() as u32;
        [count]
            .into_iter()
            .chain(pairs.map(|&body| body as u32))
            .collect()
    }
}
