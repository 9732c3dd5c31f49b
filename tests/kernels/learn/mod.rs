//! Learning: sampling, advantages, normalisation; the gradient of dense networks, and the step against it.

mod adam;
mod backward;
mod discriminator;
mod forward;
mod gae;
mod gather_rows;
mod gather_samples;
mod grad_norm;
mod gradient;
mod high_level;
mod network;
mod normalize_advantages;
mod ppo_loss;
mod reduce_grads;
mod rollout_moments;
mod sample_action;
mod skills;
