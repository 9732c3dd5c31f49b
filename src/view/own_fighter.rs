//! The fighter that somebody commands, in a bout against a policy.

use crate::env::humanoid::boxing::command::{FightCommand, ImaginedWorld};
use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::env::humanoid::task::CpuHumanoidEnv;
use std::sync::Arc;

/// Red, who obeys.
pub struct OwnFighter {
    world: ImaginedWorld,
    driver: Option<Arc<dyn BodyDriver>>,
}

impl OwnFighter {
    /// A fighter moved by the policy of the bout, or by a driver of its own; `env` is of the task that its policy has
    /// learned.
    pub fn new(env: CpuHumanoidEnv, driver: Option<Arc<dyn BodyDriver>>) -> OwnFighter {
        OwnFighter {
            world: ImaginedWorld::new(env),
            driver,
        }
    }

    /// Whether it has a driver of its own.
    pub fn has_driver(&self) -> bool {
        self.driver.is_some()
    }

    /// Actions of both fighters, `[2][action]`, in a bout with such positions and velocities, who would observe `seen`
    /// without the command. `states` are those of the bout's driver and of the fighter's own.
    pub fn act(
        &mut self,
        command: &FightCommand,
        [q, v]: [&[f32]; 2],
        seen: &[f32],
        driver: &dyn BodyDriver,
        [state, own_state]: [&mut DriverState; 2],
    ) -> Vec<f32> {
        let told = self.world.observe(command, q, v);
        let Some(own) = &self.driver else {
            let opponent = &seen[told.len()..];
            return driver.act(&[told, opponent].concat(), state);
        };
        let mut action = driver.act(seen, state);
        let own = own.act(told, own_state);
        action[..own.len()].copy_from_slice(&own);
        action
    }
}
