//! Who fights: a driver for each corner.

use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::kernels::humanoid::fighters::FIGHTERS;

/// A driver for each fighter of all worlds, red and blue, and what they remember.
pub struct Corners<'a> {
    drivers: [&'a dyn BodyDriver; FIGHTERS],
    /// What each driver remembers.
    pub states: [DriverState; FIGHTERS],
    /// Numbers of a fighter's observation.
    observation: usize,
}

impl<'a> Corners<'a> {
    /// Drivers at the start of bouts in which a fighter observes so many numbers.
    pub fn new(drivers: [&'a dyn BodyDriver; FIGHTERS], observation: usize) -> Self {
        Corners {
            drivers,
            states: Default::default(),
            observation,
        }
    }

    /// Actions `[rows][action]` for observations `[rows][observation]`, the fighters of a world side by side.
    pub fn act(&mut self, observation: &[f32]) -> Vec<f32> {
        let worlds = observation.len() / (FIGHTERS * self.observation);
        let [red, blue] = [0, 1].map(|corner| {
            let rows = observation.chunks_exact(self.observation);
            let own: Vec<f32> = rows
                .skip(corner)
                .step_by(FIGHTERS)
                .flatten()
                .copied()
                .collect();
            self.drivers[corner].act(&own, &mut self.states[corner])
        });
        let action = (red.len() / worlds.max(1)).max(1);
        let pairs = red.chunks_exact(action).zip(blue.chunks_exact(action));
        pairs.flat_map(|(red, blue)| [red, blue].concat()).collect()
    }
}
