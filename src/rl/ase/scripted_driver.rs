//! A low level that moves bodies by a script.

use super::{FrozenLowLevel, LatentDraw, STEPS_PER_DECISION};
use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::kernels::learn::low_level_input::to_latent;
use std::sync::Arc;

/// How far a body looks ahead that chooses how to move, s.
const AHEAD_S: f32 = 0.5;
/// Weight of facing the place beside a metre of the way there: who goes backwards does not see it.
const FACING: f32 = 2.0;

/// A rule that chooses latents, which nobody had to learn.
#[derive(Clone, Debug, PartialEq)]
pub enum Script {
    /// One latent is kept for good.
    Keep(Vec<f32>),
    /// Latents change as in training, by a seed.
    Random(LatentDraw, u32),
    /// The body goes towards what it observes at the index `target`, two numbers in its heading frame, m: by one of
    /// `strides` at a time.
    Approach {
        /// Index in the observation.
        target: usize,
        /// What there is to choose from; not empty.
        strides: Vec<Stride>,
    },
}

/// How a body moves under a latent.
#[derive(Clone, Debug, PartialEq)]
pub struct Stride {
    /// The latent.
    pub latent: Vec<f32>,
    /// Speed along the heading, m/s.
    pub forward: f32,
    /// Speed at which the heading turns to the left, rad/s.
    pub turn: f32,
}

impl Script {
    /// The latents of bodies that observe rows of so many numbers; `None` if they depend on more than that.
    pub fn latents(&self, observation: &[f32], width: usize) -> Option<Vec<f32>> {
        let rows = observation.chunks_exact(width);
        match self {
            Script::Keep(latent) => Some(latent.repeat(rows.len())),
            Script::Random(..) => None,
            Script::Approach { target, strides } => {
                let latents = rows.map(|row| nearest(strides, [row[*target], row[target + 1]]));
                Some(latents.collect::<Vec<_>>().concat())
            }
        }
    }

    /// Keeps the latent that an action of zeros stands for, of so many numbers.
    pub fn unsteered(latent: usize) -> Script {
        let mut kept = vec![0.0; latent];
        to_latent(&mut kept);
        Script::Keep(kept)
    }
}

/// A low level whose latents are those of a script.
pub struct ScriptedDriver {
    low_level: Arc<FrozenLowLevel>,
    script: Script,
    /// Numbers of an observation.
    observation: usize,
}

impl ScriptedDriver {
    /// Who moves bodies that observe so many numbers.
    pub fn new(low_level: &Arc<FrozenLowLevel>, script: Script, observation: usize) -> Self {
        ScriptedDriver {
            low_level: low_level.clone(),
            script,
            observation,
        }
    }
}

impl BodyDriver for ScriptedDriver {
    fn act(&self, observation: &[f32], state: &mut DriverState) -> Vec<f32> {
        if let Script::Random(draw, seed) = &self.script {
            draw.advance(observation.len() / self.observation, *seed, state);
        } else {
            if state.steps.is_multiple_of(STEPS_PER_DECISION) {
                let latents = self.script.latents(observation, self.observation);
                state.latents = latents.unwrap_or_default();
            }
            state.steps += 1;
        }
        self.low_level.act(observation, &state.latents)
    }
}

/// The latent under which a body comes nearest to a place, and faces it most, while it goes on so.
fn nearest(strides: &[Stride], [ahead, left]: [f32; 2]) -> &[f32] {
    let bearing = left.atan2(ahead);
    let score = |stride: &Stride| {
        let turned = stride.turn * AHEAD_S;
        let nearer = stride.forward * AHEAD_S * (bearing - 0.5 * turned).cos();
        nearer + FACING * (bearing - turned).cos()
    };
    let best = strides.iter().max_by(|a, b| score(a).total_cmp(&score(b)));
    best.map_or(&[], |stride| &stride.latent)
}
