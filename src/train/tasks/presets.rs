//! The choices of learning that the tasks' presets begin with.

use crate::nn::layer::{Activation, Convolution};
use crate::nn::network::NetworkConfig;
use crate::rl::amp::Amp;
use crate::rl::ppo::Ppo;
use crate::train::config::Preset;

/// RLlib's defaults of 2023, which the paper used.
pub fn paper() -> Ppo {
    Ppo {
        envs: 122,
        rollout_length: 40,
        epochs: 30,
        minibatch_size: 128,
        learning_rate: 5e-5,
        final_lr_fraction: 1.0,
        anneal_steps: 0,
        critic_learning_rate: 0.0,
        desired_kl: 0.0,
        adapt_each_minibatch: false,
        gamma: 0.99,
        lambda: 1.0,
        clip: 0.3,
        value_clip: 10.0,
        value_coefficient: 1.0,
        entropy_coefficient: 0.0,
        kl_coefficient: 0.2,
        kl_penalty_target: 0.01,
        max_grad_norm: 0.0,
        // The paper names none. At 0 a seed in three is still wandering after 100,000 steps, at 0.3 one
        // in four.
        init_log_std: 0.6,
        fixed_std: false,
        normalize_observations: false,
        network: NetworkConfig::default(),
    }
}

/// The networks of the paper (its figure 3, right), with convolutions of this stride.
pub fn convolutional(stride: usize) -> NetworkConfig {
    let convolution = |filters: usize, size: usize| Convolution {
        filters,
        size,
        stride,
    };
    NetworkConfig {
        convolutions: vec![convolution(16, 4), convolution(32, 3)],
        encoder_hidden: vec![128],
        hidden: vec![256, 128],
        activation: Activation::Relu,
    }
}

/// The learner of a body whose style a discriminator judges, with small updates for processors; or with the
/// sizes and rates that are published for large GPUs (IsaacGymEnvs' AMP).
pub fn styled(preset: Preset) -> Ppo {
    let small = Ppo {
        envs: 512,
        rollout_length: 16,
        epochs: 4,
        minibatch_size: 2048,
        // It soon finds its own; a higher one throws the first policy away.
        learning_rate: 5e-5,
        critic_learning_rate: 1e-3,
        desired_kl: 0.02,
        adapt_each_minibatch: true,
        gamma: 0.97,
        lambda: 0.95,
        init_log_std: -2.9,
        fixed_std: true,
        normalize_observations: true,
        network: relu(vec![256, 128]),
        ..Ppo::default()
    };
    match preset {
        Preset::Fast => small,
        Preset::Paper => Ppo {
            envs: 4096,
            epochs: 6,
            minibatch_size: 32768,
            critic_learning_rate: 0.0,
            desired_kl: 0.0,
            adapt_each_minibatch: false,
            gamma: 0.99,
            network: relu(vec![1024, 512]),
            ..small
        },
    }
}

/// The learner of a policy that steers a low level.
pub fn steering(preset: Preset) -> Ppo {
    let styled = styled(preset);
    Ppo {
        gamma: match preset {
            // Of a decision: a step of the body's has its fifth root, .994.
            Preset::Fast => 0.97,
            Preset::Paper => styled.gamma,
        },
        // Numbers of an action count within one, and its length not at all: this is every direction. It stays; a
        // surer policy makes its means longer.
        init_log_std: -1.0,
        ..styled
    }
}

/// The discriminator of either.
pub fn discriminator(preset: Preset) -> Amp {
    match preset {
        Preset::Fast => Amp::default(),
        Preset::Paper => Amp {
            hidden: vec![1024, 512],
            minibatch_size: 4096,
            learning_rate: 5e-5,
            replay_capacity: 100_000,
            ..Amp::default()
        },
    }
}

fn relu(hidden: Vec<usize>) -> NetworkConfig {
    NetworkConfig {
        convolutions: Vec::new(),
        encoder_hidden: Vec::new(),
        hidden,
        activation: Activation::Relu,
    }
}
