//! What a discriminator makes of the latents under which agents move.

/// What a discriminator makes of latents, which are the last numbers of an observation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LatentUse {
    /// There are none.
    #[default]
    None,
    /// An encoder of so many outputs behind its own finds them again.
    Encoded(usize),
    /// It sees so many numbers beside every window, recorded ones too: what it takes for recorded depends on them.
    Conditioned(usize),
}

impl LatentUse {
    /// Numbers of a latent.
    pub fn dim(self) -> usize {
        match self {
            LatentUse::None => 0,
            LatentUse::Encoded(dim) | LatentUse::Conditioned(dim) => dim,
        }
    }

    /// Numbers beside a window.
    pub fn shown(self) -> usize {
        match self {
            LatentUse::Conditioned(dim) => dim,
            LatentUse::None | LatentUse::Encoded(_) => 0,
        }
    }

    /// Outputs of the encoder.
    pub fn found(self) -> usize {
        self.dim() - self.shown()
    }
}

/// How agents learn that latents lead to different movements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SkillRewards {
    /// What the discriminator makes of latents.
    pub latents: LatentUse,
    /// Weight of the advantages of being found by the encoder.
    pub weight: f32,
    /// Weight of the loss of latents that lead to the same actions.
    pub diversity: f32,
}
