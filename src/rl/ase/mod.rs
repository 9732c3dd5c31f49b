//! Adversarial skill embeddings (Peng et al. 2022): a policy that moves differently under every latent, a unit
//! vector that it observes. It is [AMP](super::amp) whose environments carry latents.
//!
//! [`Ase`] holds what may be chosen, [`LatentDraw`] says which latents there are, and [`LatentEnv`] are
//! environments around environments whose agents move under them; a [`LatentDriver`] moves bodies on the host.
//!
//! When learning is over a [`FrozenLowLevel`] is left, whose skills a high-level policy may steer: [`HighLevelEnv`]
//! makes environments of a body into environments of latents, and a [`HighLevelDriver`] moves bodies on the host, a
//! [`ScriptedDriver`] those whom no policy steers.

mod batch_low_level;
mod frozen_low_level;
mod high_level_driver;
mod high_level_env;
mod latent_draw;
mod latent_driver;
mod latent_env;
mod scripted_driver;

use super::amp::{LatentUse, SkillRewards};
pub use frozen_low_level::FrozenLowLevel;
pub use high_level_driver::HighLevelDriver;
pub use high_level_env::HighLevelEnv;
pub use latent_draw::LatentDraw;
pub use latent_driver::LatentDriver;
pub use latent_env::LatentEnv;
pub use scripted_driver::{Script, ScriptedDriver};
use serde::{Deserialize, Serialize};

/// Steps of the low level that a decision of a high level lasts.
pub const STEPS_PER_DECISION: usize = 5;

/// How latents come to mean movements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum LowLevel {
    /// An encoder finds latents again in movements; which is which is up to learning.
    Ase,
    /// Every clip has a latent, and the discriminator knows it: an agent is to move like the clip of its own.
    PerClip,
}

/// Everything that may be chosen about skills.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ase {
    /// How latents come to mean movements.
    pub low_level: LowLevel,
    /// Numbers of a latent.
    pub latent: usize,
    /// Least and most steps for which a latent is kept; every number between is as likely.
    pub kept_steps: [u32; 2],
    /// Weight of the advantages of the encoder's reward, which `per-clip` has none of.
    pub skill_weight: f32,
    /// Weight of the loss of latents that lead to the same actions.
    pub diversity: f32,
    /// Standard deviation, in each direction, of latents about that of their clip.
    pub spread: f32,
}

impl Default for Ase {
    fn default() -> Self {
        // What learned the clips of `examples/L17_B5.toml` within an hour on two cores.
        Ase {
            low_level: LowLevel::PerClip,
            latent: 16,
            kept_steps: [1, 150],
            skill_weight: 0.5,
            diversity: 0.01,
            spread: 0.05,
        }
    }
}

impl Ase {
    /// What makes agents move differently under different latents.
    pub fn rewards(&self) -> SkillRewards {
        match self.low_level {
            LowLevel::Ase => SkillRewards {
                latents: LatentUse::Encoded(self.latent),
                weight: self.skill_weight,
                diversity: self.diversity,
            },
            LowLevel::PerClip => SkillRewards {
                latents: LatentUse::Conditioned(self.latent),
                weight: 0.0,
                diversity: self.diversity,
            },
        }
    }
}
