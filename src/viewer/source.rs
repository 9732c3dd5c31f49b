//! What moves the character.

use crate::motion::database::Database;
use crate::train::controller::{Controller, Scripted};
use anyhow::Result;
use std::sync::Arc;

/// What moves the character.
pub enum Source {
    /// A trained policy, on its way to targets.
    Policy(Box<dyn Controller>),
    /// Motion matching, steered by hand.
    Steered(Steered),
    /// A clip of the database as recorded, by its number.
    Clip(usize),
}

/// m/s of a stick held all the way, and with the key for running.
pub const WALK: f32 = 1.5;
/// Speed with the key for running, m/s.
pub const RUN: f32 = 4.0;
/// Distance from the character to the point that it is steered to, m.
pub const LOOK_AHEAD_M: f32 = 10.0;
/// Fraction of the difference to the requested speed that a step makes up for.
const EASE: f32 = 0.5;

/// Classic motion matching: requests a straight walk to a point that is always ahead.
pub struct Steered {
    database: Arc<Database>,
    /// m/s
    speed: f32,
}

impl Steered {
    /// A character that stands.
    pub fn new(database: Arc<Database>) -> Steered {
        Steered {
            database,
            speed: 0.0,
        }
    }

    /// Takes the speed wanted, m/s.
    pub fn ease_to(&mut self, speed: f32) {
        self.speed += EASE * (speed - self.speed);
    }
}

impl Controller for Steered {
    fn act(&self, observation: &[f32], width: usize) -> Result<Vec<f32>> {
        let scripted = Scripted {
            database: &self.database,
            speed: self.speed,
        };
        scripted.act(observation, width)
    }
}

impl Source {
    /// Who decides the next step; nobody does in a clip.
    pub fn controller(&self) -> Option<&dyn Controller> {
        match self {
            Source::Policy(policy) => Some(&**policy),
            Source::Steered(steered) => Some(steered),
            Source::Clip(_) => None,
        }
    }
}
