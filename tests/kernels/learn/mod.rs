//! Learning: sampling, advantages, normalisation.

mod gae;
mod gather_samples;
mod rollout_moments;
mod sample_action;
