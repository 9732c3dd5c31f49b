//! A low level that moves bodies by a script.

use super::{FrozenLowLevel, LatentDraw, STEPS_PER_DECISION};
use crate::env::humanoid::driver::{BodyDriver, DriverState};
use crate::kernels::learn::low_level_input::to_latent;
use crate::rl::strides::Strides;
use std::sync::Arc;

/// A rule that chooses latents, which nobody had to learn.
#[derive(Clone, Debug, PartialEq)]
pub enum Script {
    /// By what a body observes; of one latent alone, that is kept for good.
    Strides(Strides),
    /// Latents change as in training, by a seed.
    Random(LatentDraw, u32),
}

impl Script {
    /// Keeps a latent.
    pub fn keep(latent: Vec<f32>) -> Script {
        Script::Strides(Strides::one(latent))
    }

    /// Keeps the latent that an action of zeros stands for, of so many numbers.
    pub fn unsteered(latent: usize) -> Script {
        let mut kept = vec![0.0; latent];
        to_latent(&mut kept);
        Script::keep(kept)
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
        let rows = observation.chunks_exact(self.observation);
        match &self.script {
            Script::Random(draw, seed) => draw.advance(rows.len(), *seed, state),
            Script::Strides(strides) => {
                if state.steps.is_multiple_of(STEPS_PER_DECISION) {
                    let latents = rows.flat_map(|row| strides.choose(row));
                    state.latents = latents.copied().collect();
                }
                state.steps += 1;
            }
        }
        self.low_level.act(observation, &state.latents)
    }
}
