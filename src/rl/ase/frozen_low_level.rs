//! A low-level policy that learns no more, on the host.

use super::{Ase, LatentDraw};
use crate::env::EnvSpec;
use crate::nn::Policy;
use crate::rl::amp::FrozenDiscriminator;

/// A low-level policy with its discriminator, neither of which learns any more.
pub struct FrozenLowLevel {
    /// Observes the body, then a latent.
    pub policy: Policy,
    /// Tells what the policy was to move like.
    pub discriminator: FrozenDiscriminator,
    /// What was chosen of its latents.
    ase: Ase,
    /// Checksum of the recordings that it learned.
    data: u32,
    /// Numbers that a body observes of itself.
    style: usize,
}

impl FrozenLowLevel {
    /// Refuses a policy that does not observe so many numbers of a body and of a latent: the `widths`.
    ///
    /// # Errors
    /// It observes other things.
    pub fn check(policy: &Policy, widths: [usize; 2]) -> Result<(), String> {
        let (observation, [style, latent]) = (policy.observation(), widths);
        if observation.grid.is_some() || style.checked_add(latent) != Some(observation.vector) {
            let dim = observation.dim();
            return Err(format!(
                "it observes {dim} numbers, which are not {style} of a body and {latent} of a latent"
            ));
        }
        Ok(())
    }

    /// The low level of a policy that has been [checked](Self::check), of bodies that observe `style` numbers of
    /// themselves and recordings with the checksum `data`.
    pub fn new(
        policy: Policy,
        discriminator: FrozenDiscriminator,
        ase: Ase,
        style: usize,
        data: u32,
    ) -> FrozenLowLevel {
        FrozenLowLevel {
            policy,
            discriminator,
            ase,
            data,
            style,
        }
    }

    /// Its latents, if it learned recordings with this checksum, of which each clip has such a share.
    pub fn latents(&self, data: u32, shares: &[f32]) -> Option<LatentDraw> {
        (data == self.data).then(|| LatentDraw::new(&self.ase, shares))
    }

    /// Numbers that a body observes of itself, then those of a latent.
    pub fn widths(&self) -> [usize; 2] {
        [self.style, self.ase.latent]
    }

    /// Numbers of a latent.
    pub fn latent(&self) -> usize {
        self.ase.latent
    }

    /// The dimensions of environments of a body, as a policy sees them that acts through this one.
    ///
    /// # Errors
    /// It is of another body.
    pub fn steered(&self, body: &EnvSpec) -> Result<EnvSpec, String> {
        let (style, action) = (self.style, self.policy.action());
        if (style, action) != (body.style, body.action) || body.observation.grid.is_some() {
            return Err(format!(
                "it is of a body that observes {style} numbers of itself and has {action} drives, not of one with {} and {}",
                body.style, body.action
            ));
        }
        Ok(EnvSpec {
            action: self.latent(),
            dt: super::STEPS_PER_DECISION as f32 * body.dt,
            ..*body
        })
    }

    /// A checksum of all that it has learned.
    pub fn fingerprint(&self) -> u32 {
        let mut hasher = crc32fast::Hasher::new();
        let moments = self.policy.normalizer.as_ref();
        let moments = moments.map_or(&[][..], |normalizer| normalizer.moments());
        let [parameters, style_moments] = self.discriminator.learned();
        for numbers in [&self.policy.parameters, moments, parameters, style_moments] {
            hasher.update(bytemuck::cast_slice(numbers));
        }
        hasher.finalize()
    }

    /// Mean actions `[rows][action]` of bodies that observe `[rows][observation]`, under latents `[rows][latent]`.
    pub fn act(&self, observation: &[f32], latents: &[f32]) -> Vec<f32> {
        let [style, latent] = self.widths();
        let latents = latents.chunks_exact(latent);
        let width = observation.len() / latents.len().max(1);
        let rows = observation.chunks_exact(width).zip(latents);
        let input = rows.flat_map(|(row, latent)| row[..style].iter().chain(latent));
        self.policy.mean(&input.copied().collect::<Vec<f32>>())
    }
}
