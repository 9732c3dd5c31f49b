//! Thousands of independent physical worlds side by side, by shaders on a GPU or by their twins'
//! functions on all cores.
//!
//! An action lasts 1/30 s, four steps of the physics at 120 Hz. Arrays are `[field][envs]`.

pub mod cpu;
pub mod gpu;

use crate::physics::model::Model;
use crate::physics::simulator::Settings;
use crate::gpu::Device;
use crate::kernels::physics::{contact_forces, make_constraints, random_targets, reset_worlds};
use anyhow::Result;
use std::sync::Arc;

/// Faster than this, in m/s or rad/s, a world is broken and starts anew.
const FASTEST: f32 = 1e3;

#[derive(Clone, Debug)]
pub struct Setup {
    pub model: Arc<Model>,
    pub envs: usize,
    pub settings: Settings,
    pub seed: u32,
    /// Pairs of bodies whose forces on each other are wanted.
    pub watched: Vec<[usize; 2]>,
}

/// What has happened to all worlds since they began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tallies {
    /// Contacts of all steps.
    pub contacts: u64,
    /// Contacts of the step that had most.
    pub most_contacts: u32,
    /// Contacts that found no room.
    pub overflow: u64,
    /// Worlds that lost all sense and were started anew.
    pub broken: u64,
}

/// A batch of worlds on a device. Arrays of another length than is said panic.
pub trait Simulation {
    /// Draws the drives' targets, normal about zero with `deviation` rad.
    fn explore(&mut self, deviation: f32);

    /// Sets the drives' targets, `[driven][envs]`, rad.
    fn set_targets(&mut self, targets: &[f32]);

    /// Sets torques and forces on the bodies, `[bodies * 6][envs]`, Nm and N at the centres of mass in
    /// the world's frame, until they are set anew.
    fn set_pushes(&mut self, pushes: &[f32]);

    /// Plays one action; worlds that break start anew.
    fn step(&mut self);

    /// Starts the worlds whose `mask` is not 0 from `starts`, `[positions + dofs][envs]`, which is also
    /// where broken worlds will start from.
    fn restart(&mut self, mask: &[u32], starts: &[f32]);

    /// Positions and velocities, `[positions + dofs][envs]`.
    ///
    /// # Errors
    /// The device was lost.
    fn state(&self) -> Result<Vec<f32>>;

    /// Mean contact forces of the last action, `[(bodies + watched) * 3][envs]`, N in the world's frame:
    /// on every body, and by the first on the second of every watched pair; none in worlds that have started
    /// anew.
    ///
    /// # Errors
    /// The device was lost.
    fn forces(&self) -> Result<Vec<f32>>;

    /// # Errors
    /// The device was lost.
    fn tallies(&self) -> Result<Tallies>;
}

impl Setup {
    /// Positions and velocities of all worlds at the model's start.
    pub fn starts(&self) -> Vec<f32> {
        let values = self.model.start.iter().copied();
        let still = std::iter::repeat_n(0.0, self.model.velocities());
        let values = values.chain(still);
        values
            .flat_map(|value| std::iter::repeat_n(value, self.envs))
            .collect()
    }

    /// On a device.
    ///
    /// # Errors
    /// A model, or a number of worlds, too large for the device.
    pub fn on(&self, device: &Device) -> Result<Box<dyn Simulation>> {
        let rows = make_constraints::rows(&self.model, self.settings.slots);
        let quads = self.model.dofs.len().div_ceil(4);
        let numbers = 4 * quads * rows * self.envs;
        device
            .holds("constraints of all worlds", numbers)
            .map_err(|error| anyhow::anyhow!("{error}: use fewer worlds"))?;
        Ok(match device {
            Device::Cpu => Box::new(cpu::CpuSimulation::new(self)),
            Device::Gpu(gpu) => Box::new(gpu::GpuSimulation::new(self, gpu)?),
        })
    }

    fn check_targets(&self, targets: &[f32]) {
        let wanted = self.model.driven() * self.envs;
        assert_eq!(targets.len(), wanted, "targets of all drives");
    }

    fn check_pushes(&self, pushes: &[f32]) {
        let wanted = 6 * self.model.bodies.len() * self.envs;
        assert_eq!(pushes.len(), wanted, "pushes on all bodies");
    }

    fn check_starts(&self, mask: &[u32], starts: &[f32]) {
        assert_eq!(mask.len(), self.envs, "a mask of all worlds");
        let wanted = (self.model.positions() + self.model.velocities()) * self.envs;
        assert_eq!(starts.len(), wanted, "starts of all worlds");
    }

    fn explore(&self, deviation: f32, clock: u32) -> random_targets::Params {
        random_targets::Params {
            envs: self.envs as u32,
            deviation,
            seed: self.seed,
            clock,
            stream: STREAM,
        }
    }

    fn restart(&self) -> reset_worlds::Params {
        reset_worlds::Params {
            envs: self.envs as u32,
            fastest: FASTEST,
        }
    }

    /// How many pairs of bodies are watched, and they.
    fn watched(&self) -> Vec<u32> {
        let pairs = self.watched.as_flattened().iter().map(|&body| body as u32);
        [self.watched.len() as u32]
            .into_iter()
            .chain(pairs)
            .collect()
    }
}

/// Of the random targets.
const STREAM: u32 = 0x5449_4d45;

impl Tallies {
    /// Of all environments, from `[TALLIES][envs]`.
    fn of(tallies: &[u32], envs: usize) -> Tallies {
        let of = |tally: usize| tallies[tally * envs..][..envs].iter();
        let sum = |tally| of(tally).map(|&count| u64::from(count)).sum();
        Tallies {
            contacts: sum(contact_forces::CONTACTS),
            most_contacts: of(contact_forces::MOST_CONTACTS).copied().max().unwrap_or(0),
            overflow: sum(contact_forces::OVERFLOW),
            broken: sum(contact_forces::BROKEN),
        }
    }
}
