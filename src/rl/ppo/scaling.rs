//! The rule by which the choices of PPO follow the number of environments.

use super::Ppo;

impl Ppo {
    /// The choices for another number of environments that learn about as well: in `r` times as many the rollout is
    /// the square root of `r` times shorter, so that batch and minibatch grow by that root, and the learning rate by
    /// the root of it, unless it is adapted to the KL divergence. Fewer environments change nothing else.
    pub fn scaled_to(&self, envs: usize) -> Ppo {
        let scaled = Ppo {
            envs,
            ..self.clone()
        };
        if envs <= self.envs {
            return scaled;
        }
        let root = (envs as f64 / self.envs as f64).sqrt();
        let rollout_length = ((self.rollout_length as f64 / root).round() as usize).max(1);
        let batch_ratio = (envs * rollout_length) as f64 / self.batch() as f64;
        let rate_ratio = match self.desired_kl > 0.0 {
            true => 1.0,
            false => batch_ratio.sqrt(),
        };
        Ppo {
            rollout_length,
            minibatch_size: (self.minibatch_size as f64 * batch_ratio).round() as usize,
            learning_rate: self.learning_rate * rate_ratio,
            ..scaled
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the rule decides: the rollout's length, the minibatch and the learning rate.
    fn decided(ppo: &Ppo) -> (usize, usize, f64) {
        (ppo.rollout_length, ppo.minibatch_size, ppo.learning_rate)
    }

    #[test]
    fn batches_grow_by_the_square_root() {
        let preset = Ppo::default();
        assert_eq!(preset.scaled_to(256), preset);
        for (envs, wanted) in [
            (1024, (8, 1024, 2e-3 * 2_f64.sqrt())),
            (4096, (4, 2048, 4e-3)),
            (16_384, (2, 4096, 4e-3 * 2_f64.sqrt())),
        ] {
            let scaled = preset.scaled_to(envs);
            let (rollout, minibatch, rate) = decided(&scaled);
            assert_eq!(
                (scaled.envs, rollout, minibatch),
                (envs, wanted.0, wanted.1)
            );
            assert!((rate - wanted.2).abs() < 1e-12);
        }
    }

    #[test]
    fn minibatches_of_an_update_stay_as_many() {
        let preset = Ppo {
            envs: 122,
            rollout_length: 40,
            minibatch_size: 128,
            ..Ppo::default()
        };
        let minibatches = |ppo: &Ppo| ppo.batch() as f64 / ppo.minibatch_size as f64;
        for envs in [123, 244, 5000, 1 << 20] {
            let scaled = preset.scaled_to(envs);
            assert!(scaled.rollout_length > 0);
            assert!((minibatches(&scaled) / minibatches(&preset) - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn an_adapted_learning_rate_finds_its_own() {
        let preset = Ppo {
            desired_kl: 0.02,
            ..Ppo::default()
        };
        assert_eq!(decided(&preset.scaled_to(4096)), (4, 2048, 2e-3));
    }

    #[test]
    fn fewer_environments_change_nothing_else() {
        let preset = Ppo::default();
        for envs in [0, 1, 64, 255] {
            let scaled = preset.scaled_to(envs);
            assert_eq!((scaled.envs, decided(&scaled)), (envs, decided(&preset)));
        }
    }
}
