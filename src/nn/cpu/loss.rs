//! PPO's loss of each sample, and its gradient by hand: what [`crate::rl::ppo::loss`] says in tensors.

use crate::motion::features::TRAJECTORY_DIM;
use crate::rl::ppo::loss::{HALF_LOG_TAU, SCALARS, Terms};

/// What a piece of a minibatch adds up for the actor.
#[derive(Clone, Debug, Default)]
pub struct ActorSums {
    pub surrogate: f32,
    pub kl: f32,
    /// Samples whose probability ratio left the clip range.
    pub left: f32,
    /// Gradient with respect to `log_std`.
    pub log_std: [f32; TRAJECTORY_DIM],
}

impl ActorSums {
    /// In their order.
    pub fn total(pieces: &[ActorSums]) -> ActorSums {
        pieces
            .iter()
            .fold(ActorSums::default(), |sum, piece| ActorSums {
                surrogate: sum.surrogate + piece.surrogate,
                kl: sum.kl + piece.kl,
                left: sum.left + piece.left,
                log_std: std::array::from_fn(|i| sum.log_std[i] + piece.log_std[i]),
            })
    }
}

/// The actor's part of the loss.
pub struct Actor<'a> {
    pub terms: &'a Terms,
    pub log_std: &'a [f32],
    pub old_log_std: &'a [f32],
}

impl Actor<'_> {
    /// Adds up a chunk's losses and puts their gradients in the place of the means, `[rows][TRAJECTORY_DIM]`.
    pub fn judge(&self, rows: &[&[f32]], means: &mut [f32], sums: &mut ActorSums) {
        let inverse: [f32; TRAJECTORY_DIM] = std::array::from_fn(|i| (-self.log_std[i]).exp());
        let spread: [f32; TRAJECTORY_DIM] =
            std::array::from_fn(|i| self.old_log_std[i] - self.log_std[i]);
        let doubled = spread.map(|spread| (2.0 * spread).exp());
        let normal = self.log_std.iter().sum::<f32>() + TRAJECTORY_DIM as f32 * HALF_LOG_TAU as f32;
        // KL(old || new) of diagonal Gaussians of the same mean.
        let widened: f32 = (0..TRAJECTORY_DIM)
            .map(|i| 0.5 * (doubled[i] - 1.0) - spread[i])
            .sum();
        let terms = self.terms;
        for (row, mean) in rows.iter().zip(means.chunks_exact_mut(TRAJECTORY_DIM)) {
            let learned = &row[row.len() - 2 * TRAJECTORY_DIM - SCALARS..];
            let (action, old_mean) = (&learned[..TRAJECTORY_DIM], &learned[TRAJECTORY_DIM..]);
            let [old_log_prob, advantage] = [0, 1].map(|i| learned[2 * TRAJECTORY_DIM + i]);
            let noise: [f32; TRAJECTORY_DIM] =
                std::array::from_fn(|i| (action[i] - mean[i]) * inverse[i]);
            let moved: [f32; TRAJECTORY_DIM] =
                std::array::from_fn(|i| (old_mean[i] - mean[i]) * inverse[i]);
            let square = |of: &[f32; TRAJECTORY_DIM]| of.iter().map(|x| x * x).sum::<f32>();
            let ratio = (-0.5 * square(&noise) - normal - old_log_prob).exp();
            let clip = terms.clip as f32;
            let clipped = ratio.clamp(1.0 - clip, 1.0 + clip);
            sums.surrogate -= (ratio * advantage).min(clipped * advantage);
            sums.kl += 0.5 * square(&moved) + widened;
            sums.left += f32::from(ratio != clipped);
            // Where the clipped one is less, nothing depends on the ratio.
            let passes = ratio * advantage <= clipped * advantage;
            let pull = if passes { -advantage * ratio } else { 0.0 };
            let kl = terms.kl_coefficient as f32;
            for i in 0..TRAJECTORY_DIM {
                mean[i] = (pull * noise[i] - kl * moved[i]) * inverse[i] * terms.share;
                let by_noise = pull * (noise[i] * noise[i] - 1.0);
                let by_kl = kl * (1.0 - doubled[i] - moved[i] * moved[i]);
                let entropy = terms.entropy_coefficient as f32;
                sums.log_std[i] += (by_noise + by_kl - entropy) * terms.share;
            }
        }
    }

    /// Of the new policy, the same for every sample.
    pub fn entropy(&self) -> f32 {
        let constant = TRAJECTORY_DIM as f32 * (0.5 + HALF_LOG_TAU as f32);
        self.log_std.iter().sum::<f32>() + constant
    }
}

/// Adds up the critic's losses of a chunk and puts their gradients in the place of the `values`.
pub fn critic(terms: &Terms, rows: &[&[f32]], values: &mut [f32], sum: &mut f32) {
    let (limit, weight) = (terms.value_clip as f32, terms.value_coefficient as f32);
    for (row, value) in rows.iter().zip(values) {
        let [target, old] = [2, 3].map(|i| row[row.len() - SCALARS + i]);
        let error = *value - target;
        let moved = *value - old;
        let near = old + moved.clamp(-limit, limit) - target;
        // Where the limited change counts, nothing depends on the value.
        let limited = limit > 0.0 && moved.abs() > limit && near * near > error * error;
        *sum += 0.5 * if limited { near * near } else { error * error };
        *value = if limited {
            0.0
        } else {
            error * weight * terms.share
        };
    }
}
